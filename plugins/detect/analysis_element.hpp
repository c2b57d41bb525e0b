// SPDX-License-Identifier: LGPL-2.1-or-later
// An analysing element from three things: an Analyser, a table of properties, and what it is called.
//
//   struct Private final : Analyser { CerberusAnalysis* base; Adjustable<Settings> settings; ... };
//   constexpr AnalysisInfo kInfo{"CerberusThing", "Thing", "What it does"};
//   GType thing_get_type() { return analysis_type<Private, kProperties, kInfo>(); }
//   CERBERUS_REGISTER_ELEMENT(thing, GST_RANK_NONE, cerberus::plugin::thing, thing_debug, "what it does")
#pragma once

#include "analysis_base.hpp"
#include "shared/properties.hpp"

namespace cerberus::plugin {

struct AnalysisInfo {
  const char* type;  // of the GType
  const char *name, *description;
};

namespace detail {

template <typename Private, const auto& table, const AnalysisInfo& info>
struct AnalysisTraits {
  struct Self : cerberus::detail::Instance<CerberusAnalysis, Private> {};
  struct Class {
    CerberusAnalysisClass parent_class;
  };
  using Object = Private;
  static const char* name() { return info.type; }
  static GType parent() { return cerberus_analysis_get_type(); }
  static void init(Self* self) {
    self->priv->base = &self->parent;
    cerberus_analysis_init_with(&self->parent, self->priv);
  }
  static void class_init(Class* klass) {
    install_properties<Self, table>(G_OBJECT_CLASS(klass));
    gst_element_class_set_static_metadata(GST_ELEMENT_CLASS(klass), info.name, "Filter/Analyzer/Video",
                                          info.description, "The Cerberus developers");
  }
  static void interfaces(GType) {}
};

}  // namespace detail

template <typename Private, const auto& table, const AnalysisInfo& info>
GType analysis_type() {
  return cerberus::detail::TypeBuilder<detail::AnalysisTraits<Private, table, info>>::get();
}

}  // namespace cerberus::plugin
