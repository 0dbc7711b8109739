#pragma once

#include <string>
#include <string_view>

namespace candela::figures {

/// Text as the content of an element or an attribute of XML and HTML; control characters but tab and line feed, which
/// neither can hold, are left out.
std::string escaped(std::string_view text);

/// A formula as a MathML element (MathML Core), from the part of TeX that our formulas need: letters are variables,
/// digits with a decimal point numbers, `{…}` a group, `_` and `^` scripts, `\frac{a}{b}`, `\sqrt{a}`, `\op{max}` the
/// name of a function, `\text{if }` with its blanks, `\,` a thin space; other blanks separate
/// and are not set; all else is an operator. What stands in parentheses is a group with them. Greek letters, ∫, Σ and ·
/// stand as themselves. Throws Error where a brace or an argument is missing.
std::string mathml(std::string_view formula);

}  // namespace candela::figures
