// SPDX-License-Identifier: LGPL-2.1-or-later
// How a C++ element becomes a GObject type, and how its exceptions stay out of C frames.
//
//   struct Private { std::mutex lock; Settings settings; State state; };   // a real C++ object
//   CERBERUS_DEFINE_TYPE(CerberusThing, cerberus_thing, GstBaseTransform, GST_TYPE_BASE_TRANSFORM, Private)
//   static void cerberus_thing_init(CerberusThing* self) { ... self->priv is constructed already ... }
//   static void cerberus_thing_class_init(CerberusThingClass* klass) { ... }   // never sets `finalize`
//   CERBERUS_REGISTER_ELEMENT(thing, GST_RANK_NONE, cerberus_thing, category, "what it does")   // file end
//
// Private's destructor is the type's finalizer: it runs before the parent class finalizes.
// GType names are process-wide and the boxed types of <cerberus/cerberus.h> have theirs: elements whose name
// would collide (CerberusCameraMotion) take the suffix Element.
#pragma once

#include <gst/gst.h>

#include <exception>
#include <new>
#include <type_traits>
#include <utility>

#include "cerberus/private/messages.hpp"

namespace cerberus {

namespace detail {

// Parent, the C++ object's address, and nothing else: this is what `TypeName` is.
template <typename Parent, typename Private>
struct Instance {
  Parent parent;
  Private* priv;
};

// Registration, construction and destruction, once for all types. Traits: Self, Class, Object, name(),
// parent(), init(), class_init(), interfaces().
template <typename Traits>
class TypeBuilder {
  using Self = typename Traits::Self;
  using Private = typename Traits::Object;
  static_assert(alignof(Private) <= 2 * sizeof(gsize), "GObject aligns private data to two words only");
  // GObject counts what a type and all its parents have in 16 bits. Those of GStreamer have less than 4 KiB together.
  static_assert(sizeof(Private) <= G_MAXUINT16 - 4096, "GObject has no more room for private data");

 public:
  static inline gpointer parent_class = nullptr;

  static GType get() {
    static const GType type = add();
    return type;
  }

 private:
  static inline gint private_offset = 0;

  static GType add() {
    const GType type = g_type_register_static_simple(
        Traits::parent(), g_intern_static_string(Traits::name()), sizeof(typename Traits::Class),
        [](gpointer klass, gpointer) { class_init(klass); }, sizeof(Self),
        [](GTypeInstance* instance, gpointer) { init(reinterpret_cast<Self*>(instance)); }, GTypeFlags(0));
    private_offset = g_type_add_instance_private(type, sizeof(Private));
    Traits::interfaces(type);
    return type;
  }

  static void class_init(gpointer klass) {
    parent_class = g_type_class_peek_parent(klass);
    g_type_class_adjust_private_offset(klass, &private_offset);
    G_OBJECT_CLASS(klass)->finalize = finalize;
    Traits::class_init(static_cast<typename Traits::Class*>(klass));
    g_assert(G_OBJECT_CLASS(klass)->finalize == finalize);  // Private's destructor is the finalizer
  }

  // A constructor that throws ends the program here, as GLib does when memory runs out: g_object_new() cannot fail.
  static void init(Self* self) noexcept {
    self->priv = ::new (G_STRUCT_MEMBER_P(self, private_offset)) Private();
    Traits::init(self);
  }

  static void finalize(GObject* object) noexcept {
    reinterpret_cast<Self*>(object)->priv->~Private();
    G_OBJECT_CLASS(parent_class)->finalize(object);
  }
};

// The one place where an exception becomes an error message. Call inside a catch block.
inline void post_current_exception(GstElement* element) noexcept {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    CERBERUS_ELEMENT_ERROR(element, RESOURCE, NO_SPACE_LEFT, ("Not enough memory."), ("std::bad_alloc"));
  } catch (const std::exception& e) {
    CERBERUS_ELEMENT_ERROR(element, LIBRARY, FAILED, ("Internal error: %s", e.what()),
                           ("uncaught C++ exception"));
  } catch (...) {
    CERBERUS_ELEMENT_ERROR(element, LIBRARY, FAILED, ("Internal error."),
                           ("uncaught C++ exception of unknown type"));
  }
}

}  // namespace detail

// Runs `body` and returns its result; whatever it throws becomes one error message on `element`, and
// `fallback`.
//   return guarded(self, GST_FLOW_ERROR, [&] { ...; return GST_FLOW_OK; });
template <typename Element, typename Fallback, typename Body>
auto guarded(Element* element, Fallback fallback, Body&& body) noexcept -> std::invoke_result_t<Body> {
  try {
    return std::forward<Body>(body)();
  } catch (...) {
    detail::post_current_exception(reinterpret_cast<GstElement*>(element));
  }
  return static_cast<std::invoke_result_t<Body>>(fallback);
}

// The same for bodies without a result.
template <typename Element, typename Body>
  requires std::is_void_v<std::invoke_result_t<Body>>
void guarded(Element* element, Body&& body) noexcept {
  guarded(element, 0, [&] { return std::forward<Body>(body)(), 0; });
}

}  // namespace cerberus

// Declares TypeName, TypeName##Class, type_name##_get_type(), type_name##_parent_class() and
// type_name##_self(pointer); the file defines type_name##_init(TypeName*) and
// type_name##_class_init(TypeName##Class*). Optional last argument: code that adds interfaces to the GType
// `type`. Use it in an anonymous namespace or at file scope.
#define CERBERUS_DEFINE_TYPE(TypeName, type_name, Parent, PARENT_TYPE, PrivateType, ...)                 \
  struct TypeName : ::cerberus::detail::Instance<Parent, PrivateType> {};                                \
  struct TypeName##Class {                                                                               \
    Parent##Class parent_class;                                                                          \
  };                                                                                                     \
  static void type_name##_init(TypeName* self);                                                          \
  static void type_name##_class_init(TypeName##Class* klass);                                            \
  struct TypeName##Traits {                                                                              \
    using Self = TypeName;                                                                               \
    using Class = TypeName##Class;                                                                       \
    using Object = PrivateType;                                                                          \
    static constexpr auto name = [] { return #TypeName; };                                               \
    static constexpr auto parent = []() -> GType { return PARENT_TYPE; };                                \
    static constexpr auto init = type_name##_init;                                                       \
    static constexpr auto class_init = type_name##_class_init;                                           \
    static constexpr auto interfaces = []([[maybe_unused]] GType type) { __VA_ARGS__; };                 \
  };                                                                                                     \
  [[maybe_unused]] static GType type_name##_get_type() {                                                 \
    return ::cerberus::detail::TypeBuilder<TypeName##Traits>::get();                                     \
  }                                                                                                      \
  [[maybe_unused]] static Parent##Class* type_name##_parent_class() {                                    \
    return static_cast<Parent##Class*>(::cerberus::detail::TypeBuilder<TypeName##Traits>::parent_class); \
  }                                                                                                      \
  [[maybe_unused]] static TypeName* type_name##_self(gpointer instance) {                                \
    return static_cast<TypeName*>(instance);                                                             \
  }

// Defines gst_element_register_<element>() for plugin.cpp (GST_ELEMENT_REGISTER_DECLARE(<element>) there) and
// sets up the debug category, a GstDebugCategory* of the file. At file scope, after everything else.
#define CERBERUS_REGISTER_ELEMENT(element, rank, type_name, category, description) \
  extern "C" gboolean gst_element_register_##element(GstPlugin* plugin);           \
  extern "C" gboolean gst_element_register_##element(GstPlugin* plugin) {          \
    GST_DEBUG_CATEGORY_INIT(category, #element, 0, description);                   \
    return gst_element_register(plugin, #element, rank, type_name##_get_type());   \
  }
