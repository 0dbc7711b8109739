#!/usr/bin/env python3
"""Write C++ that holds a file: tools/embed_bytes.py FILE OUT.cpp NAMESPACE HEADER FUNCTION

HEADER declares the function, which returns a std::string_view, in the namespace."""

import pathlib
import sys

CHUNK = 4000  # bytes of a literal


def literal(data):
    # Octal, because a hexadecimal escape would go on with the next character.
    return '"' + "".join(f"\\{byte:03o}" for byte in data) + '"'


def main():
    path, out, namespace, header, function = sys.argv[1:]
    data = pathlib.Path(path).read_bytes()
    pieces = [literal(data[i : i + CHUNK]) for i in range(0, len(data), CHUNK)]
    text = "\n    ".join(pieces)
    pathlib.Path(out).write_text(
        f'#include "{header}"\n\nnamespace {namespace} {{\n\nstd::string_view {function}() {{\n'
        f"  static constexpr char data[] =\n    {text};\n  return {{data, sizeof data - 1}};\n}}\n\n}}  // namespace {namespace}\n",
        encoding="ascii",
    )


if __name__ == "__main__":
    main()
