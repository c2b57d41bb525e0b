// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/soap/xml.h"

#include <libxml/parser.h>
#include <libxml/tree.h>

#include <charconv>
#include <cmath>
#include <mutex>

namespace cerberus::drivers::onvif {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view view(const xmlChar* text) {
  return text ? std::string_view(reinterpret_cast<const char*>(text)) : std::string_view();
}

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(kBlanks);
  return begin == text.npos ? std::string_view()
                            : text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

std::optional<double> to_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// True for the text behind an `&` that begins a reference: `amp;`, `#38;`, `#x26;`.
bool is_reference(std::string_view rest) {
  for (const std::string_view name : {"amp;", "lt;", "gt;", "quot;", "apos;"})
    if (rest.starts_with(name)) return true;
  if (!rest.starts_with('#')) return false;
  const bool hexadecimal = rest.size() > 1 && rest[1] == 'x';
  rest.remove_prefix(hexadecimal ? 2 : 1);
  const auto end = rest.find_first_not_of(hexadecimal ? "0123456789abcdefABCDEF" : "0123456789");
  return end != rest.npos && end > 0 && rest[end] == ';';
}

std::string with_references(std::string_view bytes) {
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    out += bytes[i];
    if (bytes[i] == '&' && !is_reference(bytes.substr(i + 1))) out += "amp;";
  }
  return out;
}

xmlDoc* read(std::string_view bytes) {
  return xmlReadMemory(bytes.data(), static_cast<int>(bytes.size()), nullptr, nullptr,
                       XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING | XML_PARSE_NOCDATA);
}

}  // namespace

void XmlDocument::Free::operator()(xmlDoc* document) const noexcept {
  xmlFreeDoc(document);
}

std::optional<XmlDocument> XmlDocument::parse(std::string_view bytes) {
  static std::once_flag once;
  std::call_once(once, [] { xmlInitParser(); });
  // A document type is where entities are declared. Encodings of two bytes a character could hide one.
  if (bytes.size() > kMostXml || bytes.find('\0') != bytes.npos || bytes.find("<!DOCTYPE") != bytes.npos)
    return std::nullopt;
  const auto begin = bytes.find_first_not_of(kBlanks);  // some cameras send an empty line first
  if (begin == bytes.npos) return std::nullopt;
  bytes.remove_prefix(begin);
  xmlDoc* document = read(bytes);
  if (!document) document = read(with_references(bytes));
  if (!document) return std::nullopt;
  XmlDocument parsed(document);
  if (document->intSubset || !xmlDocGetRootElement(document)) return std::nullopt;
  return parsed;
}

XmlElement XmlDocument::root() const {
  return XmlElement(xmlDocGetRootElement(document_.get()));
}

std::string_view XmlElement::name() const {
  return node_ ? view(node_->name) : std::string_view();
}

XmlElement XmlElement::child(std::string_view name) const {
  for (const xmlNode* node = node_ ? node_->children : nullptr; node; node = node->next)
    if (node->type == XML_ELEMENT_NODE && view(node->name) == name) return XmlElement(node);
  return {};
}

std::vector<XmlElement> XmlElement::children(std::string_view name) const {
  std::vector<XmlElement> found;
  for (const xmlNode* node = node_ ? node_->children : nullptr; node; node = node->next)
    if (node->type == XML_ELEMENT_NODE && view(node->name) == name) found.emplace_back(node);
  return found;
}

XmlElement XmlElement::find(std::string_view name) const {
  const xmlNode* node = node_;
  while (node) {
    if (node != node_ && node->type == XML_ELEMENT_NODE && view(node->name) == name) return XmlElement(node);
    if (node->type == XML_ELEMENT_NODE && node->children) {
      node = node->children;
      continue;
    }
    while (node != node_ && !node->next) node = node->parent;
    if (node == node_) return {};
    node = node->next;
  }
  return {};
}

std::string XmlElement::text() const {
  std::string text;
  for (const xmlNode* node = node_ ? node_->children : nullptr; node; node = node->next)
    if (node->type == XML_TEXT_NODE || node->type == XML_CDATA_SECTION_NODE) text += view(node->content);
  return std::string(trimmed(text));
}

std::optional<double> XmlElement::number() const {
  return to_number(text());
}

std::string XmlElement::attribute(const char* name) const {
  if (!node_) return {};
  // The arguments of the C interface are not const; nothing is changed.
  xmlChar* value = xmlGetProp(const_cast<xmlNode*>(node_), reinterpret_cast<const xmlChar*>(name));
  std::string text(trimmed(view(value)));
  xmlFree(value);
  return text;
}

std::optional<double> XmlElement::number(const char* name) const {
  return to_number(attribute(name));
}

std::string xml_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n' || c == '\r')
      out += c;
  }
  return out;
}

}  // namespace cerberus::drivers::onvif
