#!/usr/bin/env python3
"""Write C++ that holds text files by name: tools/embed_text.py OUT.cpp NAMESPACE HEADER FUNCTION NAME=PATH...

HEADER declares the function in the namespace."""

import sys

CHUNK = 12000  # compilers limit a literal


def literal(text):
    parts = [text[i : i + CHUNK] for i in range(0, len(text), CHUNK)] or [""]
    return "\n".join(f'R"~~({part})~~"' for part in parts)


def main():
    out, namespace, header, function, *files = sys.argv[1:]
    lines = [f'#include "{header}"', "", f"namespace {namespace} {{", "",
             f"const std::map<std::string, std::string, std::less<>>& {function}() {{",
             "  static const std::map<std::string, std::string, std::less<>> files = {"]
    for entry in files:
        name, path = entry.split("=", 1)
        with open(path, encoding="utf-8") as file:
            lines.append(f'    {{"{name}",\n{literal(file.read())}}},')
    lines += ["  };", "  return files;", "}", "", f"}}  // namespace {namespace}", ""]
    with open(out, "w", encoding="utf-8") as file:
        file.write("\n".join(lines))


if __name__ == "__main__":
    main()
