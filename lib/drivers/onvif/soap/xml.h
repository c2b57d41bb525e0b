// SPDX-License-Identifier: LGPL-2.1-or-later
// XML that a camera sends, read by libxml2: no network, no document type, no entities beyond XML's own five, and bounded
// in size and depth.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

struct _xmlDoc;
struct _xmlNode;

namespace cerberus::drivers::onvif {

inline constexpr std::size_t kMostXml =
    512 * 1024;  // bytes; the answers that are asked for have less than 100 KiB

// An element of a document, valid as long as its document. A default one is absent: its text is empty, and so are its
// children. Elements are found by local names: some cameras declare wrong namespaces.
class XmlElement {
 public:
  XmlElement() = default;
  explicit XmlElement(const _xmlNode* node) : node_(node) {}
  explicit operator bool() const { return node_ != nullptr; }
  std::string_view name() const;
  // The first child element of that name; absent if there is none.
  XmlElement child(std::string_view name) const;
  // All child elements of that name.
  std::vector<XmlElement> children(std::string_view name) const;
  // The first descendant of that name in document order.
  XmlElement find(std::string_view name) const;
  // The text without blanks at its ends, and without that of child elements.
  std::string text() const;
  // The text as a number in any locale; nothing if it is none or not finite.
  std::optional<double> number() const;
  std::string attribute(const char* name) const;
  std::optional<double> number(const char* attribute) const;

 private:
  const _xmlNode* node_ = nullptr;
};

class XmlDocument {
 public:
  // Nothing: it is no well-formed XML, is too large or has a document type. A bare `&`, which cameras leave in URIs, is
  // taken for `&amp;`.
  static std::optional<XmlDocument> parse(std::string_view bytes);
  XmlElement root() const;

 private:
  struct Free {
    void operator()(_xmlDoc* document) const noexcept;
  };
  explicit XmlDocument(_xmlDoc* document) : document_(document) {}
  std::unique_ptr<_xmlDoc, Free> document_;
};

// For text and for attributes in double quotes; characters that XML cannot carry are left out.
std::string xml_escaped(std::string_view text);

}  // namespace cerberus::drivers::onvif
