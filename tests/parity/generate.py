#!/usr/bin/env python3
"""Write the table of every SHADE_FN of src/shade/*.glsl.h, callable from C++ and from GLSL over plain floats.

    generate.py ROOT OUTPUT.cpp    ROOT is src/, the folder that "shade/x.glsl.h" is relative to
    generate.py --self-test        planted headers are read, and refused, as they should be

Every parameter and result is flattened to floats, structs member by member; what a function fills in place
(SHADE_INOUT) is both. A SHADE_FN that cannot be read, or whose types are not understood, stops the build: nothing that
is shared goes untested. Text that only one language sees is not shared; a function declared in both branches of an
#ifdef __cplusplus is.
"""

import pathlib
import re
import sys
import tempfile
from dataclasses import dataclass, field

# Type -> its floats, read from a value {v}; and the value made from floats {0}, {1}, … All of it is C++ and GLSL alike.
XYZW = "xyzw"
TYPES = {
    "float": (["{v}"], "{0}"),
    "int": (["float({v})"], "int({0})"),
    "bool": (["float({v})"], "{0} > 0.5f"),
    "mat3": ([f"{{v}}[{c}].{r}" for c in range(3) for r in "xyz"], "mat3({all})"),
}
for size in (2, 3, 4):
    TYPES[f"vec{size}"] = ([f"{{v}}.{XYZW[i]}" for i in range(size)], f"vec{size}({{all}})")

# Members that hold something only under a condition on the struct {s}; elsewhere they are undefined, and read as absent
# (0 for what is no float). A new member of Surface that some lobe needs belongs here.
SOMETIMES = {
    "Surface": [
        (r"conductor_.*", "({s}.lobes & kLobeConductor) != 0"),
        (r"sheen_alpha|sheen_roughness", "({s}.lobes & kLobesOfFibres) != 0"),
        (r"film_(beyond|escape|below_scale)", "{s}.lobes != 0 && {s}.has_film_below"),
        (r"diffuse_balance_.*", "({s}.lobes & kLobeDiffuseRoughness) != 0 && {s}.diffuse_roughness > 0.0f"),
        (r"coat_(color|darkening|tint_o)", "({s}.lobes & kLobeClearcoat) != 0 && !{s}.is_coat_clear"),
        (r"coat_(alpha|widths|roughness|normal|row|escape_.*)|is_coat_mirror", "({s}.lobes & kLobeClearcoat) != 0"),
        (r"model|alpha_.|iridescence|film_.*|has_film_below|has_f82_tint|f82_tint|f90_tint|is_sheen_on_top|is_thin|is_glass_delta|eta|glass_.*|diffuse_below.*|diffuse_color|diffuse_roughness|retroreflection|sheen.*|coat.*"
         r"|is_coat_clear|chance_(glass|diffuse_below|sheen|coat)", "{s}.lobes != 0"),
    ],
}
ABSENT = "-3.0e38f"  # kAbsent of tests/parity/function.h

IDENTIFIER = r"[A-Za-z_]\w*"
FUNCTION = re.compile(
    rf"\bSHADE_FN\s+({IDENTIFIER})\s+({IDENTIFIER})\s*\(((?:[^()]|\bSHADE_(?:IN|INOUT)\([^()]*\))*)\)\s*[{{;]")
STRUCT = re.compile(rf"\bstruct\s+({IDENTIFIER})\s*\{{([^{{}}]*)\}}\s*;")
CONSTANT = re.compile(rf"\bSHADE_CONST\s+int\s+({IDENTIFIER})\s*=\s*(\d+)\s*;")
MEMBER = re.compile(rf"({IDENTIFIER})(?:\s*\[\s*(\w+)\s*\])?$")


class Refusal(Exception):
    """What is not understood, and where."""


@dataclass
class Value:
    """A parameter, a member or a result: `size` floats from `offset`."""

    name: str
    type: str
    owner: str  # the struct or function that names it
    offset: int
    size: int
    code: str  # the expression, e.g. a0.base_color
    condition: str = ""  # when it holds something; empty = always
    members: list = field(default_factory=list)


@dataclass
class Function:
    name: str
    header: str
    line: int
    result: str
    parameters: list  # (type, name, whether it is filled in place)


def without_comments(text):
    """The text with comments and line continuations blanked, every line where it was."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.DOTALL)


def split_by_language(text, where):
    """(what C++ reads, what GLSL reads), with preprocessor lines and the other language's lines blank."""
    sides = {"cpp": [], "glsl": []}
    stack = []  # for each open #if: the language of the present branch, or "" for a condition on something else
    other = {"cpp": "glsl", "glsl": "cpp", "": ""}
    for number, line in enumerate(text.split("\n"), 1):
        directive = re.match(r"\s*#\s*(\w+)\s*(.*)", line)
        if directive:
            word, rest = directive.groups()
            if word in ("if", "ifdef", "ifndef"):
                about_cpp = "__cplusplus" in rest
                negated = word == "ifndef" or "!" in rest
                stack.append(("glsl" if negated else "cpp") if about_cpp else "")
            elif word in ("else", "elif") and stack:
                if word == "elif" and stack[-1]:
                    raise Refusal(f"{where}:{number}: #elif on __cplusplus")
                stack[-1] = other[stack[-1]]
            elif word == "endif" and stack:
                stack.pop()
        for language, lines in sides.items():
            lines.append("" if directive or other[language] in stack else line)
    return "\n".join(sides["cpp"]), "\n".join(sides["glsl"])


def parse_parameters(text, where):
    parameters = []
    for one in filter(None, (part.strip() for part in text.split(","))):
        macro = re.match(r"SHADE_(IN|INOUT)\(\s*(\w+)\s*\)", one)
        plain = macro.group(2) + one[macro.end():] if macro else one
        words = [word for word in plain.split() if word not in ("const", "in", "highp")]
        if len(words) != 2 or not all(re.fullmatch(IDENTIFIER, word) for word in words):
            raise Refusal(f"{where}: parameter '{one}' is not 'type name'")
        parameters.append((*words, macro is not None and macro.group(1) == "INOUT"))
    return parameters


def parse_members(text, constants, where):
    """[(type, name, code suffix)], an array once per element."""
    members = []
    for declaration in filter(None, (part.strip() for part in text.split(";"))):
        type_name, _, names = declaration.partition(" ")
        for name in names.split(","):
            match = MEMBER.match(name.strip())
            if not match:
                raise Refusal(f"{where}: member '{declaration}' is not 'type name'")
            name, count = match.groups()
            if count is None:
                members.append((type_name, name, name))
                continue
            count = int(count) if count.isdigit() else constants.get(count)
            if count is None:
                raise Refusal(f"{where}: size of member '{name}' is unknown")
            members += [(type_name, name, f"{name}[{i}]") for i in range(count)]
    return members


class Headers:
    """Structs and functions of every header."""

    def __init__(self, root):
        self.files = sorted(path.relative_to(root).as_posix() for path in (root / "shade").glob("*.glsl.h"))
        self.structs, self.constants, functions = {}, {}, {"cpp": {}, "glsl": {}}
        texts = {}
        for name in self.files:
            texts[name] = split_by_language(without_comments((root / name).read_text(encoding="utf-8")), name)
            for match in CONSTANT.finditer(texts[name][1]):
                self.constants[match.group(1)] = int(match.group(2))
        for name in self.files:
            for language, text in zip(("cpp", "glsl"), texts[name]):
                self.read(name, text, functions[language])
        self.functions = [one for key, one in functions["cpp"].items() if key in functions["glsl"]]

    def read(self, name, text, functions):
        at = lambda position: f"{name}:{text.count(chr(10), 0, position) + 1}"
        for match in STRUCT.finditer(text):
            self.structs[match.group(1)] = parse_members(match.group(2), self.constants, at(match.start()))
        understood = set()
        for match in FUNCTION.finditer(text):
            understood.add(match.start())
            parameters = parse_parameters(match.group(3), at(match.start()))
            key = (match.group(2), tuple(kind for kind, _, _ in parameters))
            line = int(at(match.start()).rpartition(":")[2])
            functions.setdefault(key, Function(match.group(2), name, line, match.group(1), parameters))
        for match in re.finditer(r"\bSHADE_FN\b", text):
            if match.start() not in understood:
                raise Refusal(f"{at(match.start())}: this SHADE_FN is not 'type name(type name, …)'")

    def value(self, type_name, name, owner, code, offset, where, condition=""):
        if type_name in TYPES:
            return Value(name, type_name, owner, offset, len(TYPES[type_name][0]), code, condition)
        if type_name not in self.structs:
            raise Refusal(f"{where}: type {type_name} is not understood; teach TYPES in tests/parity/generate.py")
        value = Value(name, type_name, owner, offset, 0, code)
        for member_type, member, suffix in self.structs[type_name]:
            when = condition
            for pattern, only in SOMETIMES.get(type_name, ()) if not when else ():
                if re.fullmatch(pattern, member):
                    when = only.format(s=code)
                    break
            inner = self.value(member_type, member, type_name, f"{code}.{suffix}", offset + value.size, where, when)
            value.members.append(inner)
            value.size += inner.size
        return value


    def output(self, function, where):
        """What comes back: the result, or what is filled in place, or both as the members of a nameless struct."""
        parts, offset = [], 0
        if function.result != "void":
            parts.append((function.result, "", "r"))
        parts += [(kind, name, f"a{i}") for i, (kind, name, in_place) in enumerate(function.parameters) if in_place]
        if not parts:
            raise Refusal(f"{where}: {function.name} returns nothing")
        values = []
        for kind, name, code in parts:
            values.append(self.value(kind, name, function.name, code, offset, where))
            offset += values[-1].size
        return values[0] if len(values) == 1 else Value("", "outputs", function.name, 0, offset, "", members=values)


def leaves(value):
    if not value.members:
        return [value]
    return [leaf for member in value.members for leaf in leaves(member)]


def body(function, inputs, output):
    """Statements that are C++ and GLSL: from float x[] through the function to float y[]."""
    lines = []
    for value in inputs:
        declared = f"{value.type} {value.code}"
        if value.members:
            lines.append(f"{declared};")
        for leaf in leaves(value):
            floats = [f"x[{leaf.offset + i}]" for i in range(leaf.size)]
            made = TYPES[leaf.type][1].format(*floats, all=", ".join(floats))
            lines.append(f"{leaf.code if value.members else declared} = {made};")
    result = "" if function.result == "void" else f"{function.result} r = "
    lines.append(f"{result}{function.name}({', '.join(value.code for value in inputs)});")
    for leaf in leaves(output):
        absent = "0.0f" if leaf.type in ("int", "bool") else ABSENT
        for i, read in enumerate(TYPES[leaf.type][0]):
            text = read.format(v=leaf.code)
            if leaf.condition:
                text = f"{leaf.condition} ? {text} : {absent}"
            lines.append(f"y[{leaf.offset + i}] = {text};")
    return lines


def rows_of(value):
    """FlatValue of tests/parity/function.h: the value, then its members."""
    row = f'{{"{value.name}", "{value.type}", "{value.owner}", {value.offset}, {value.size}, {len(value.members)}}},'
    return [row] + [inner for member in value.members for inner in rows_of(member)]


def generate(root):
    headers = Headers(root)
    names = [function.name for function in headers.functions]
    calls, rows = [], []
    for index, function in enumerate(headers.functions):
        where = f"{function.header}:{function.line}"
        inputs, offset = [], 0
        for number, (type_name, name, _) in enumerate(function.parameters):
            inputs.append(headers.value(type_name, name, function.name, f"a{number}", offset, where))
            offset += inputs[-1].size
        output = headers.output(function, where)
        statements = body(function, inputs, output)
        # Overloads are told apart by the types of their parameters.
        name = function.name
        if names.count(name) > 1:
            name += "".join(f"_{kind}" for kind, _, _ in function.parameters)
        # Without parameters nothing reads x.
        x = "const float* x" if inputs else "const float* /*x*/"
        calls.append(f"void call_{index}({x}, float* y) {{\n  " + "\n  ".join(statements) + "\n}\n")
        values = [row for value in (*inputs, output) for row in rows_of(value)]
        calls.append(f"constexpr FlatValue kValues{index}[] = {{\n    " + "\n    ".join(values) + "\n};\n")
        rows.append(
            f'    {{"{name}", "{function.header}", {function.line}, {len(inputs)}, {offset}, kValues{index}, '
            f'call_{index}, ' 'R"glsl(  ' + "\n  ".join(statements) + '\n)glsl"},'
        )
    includes = "\n".join(f'#include "{name}"' for name in headers.files)
    return (
        "// Written by tests/parity/generate.py.\n\n"
        f'#include "parity/function.h"\n\n{includes}\n\n'
        "namespace candela::parity {\nnamespace {\n\nusing namespace candela::shade;\n\n"
        + "\n".join(calls)
        + "\n}  // namespace\n\nconst FlatFunction kFlatFunctions[] = {\n"
        + "\n".join(rows)
        + f"\n}};\nconst int kFlatFunctionCount = {len(rows)};\n\n}}  // namespace candela::parity\n"
    )


PLANTED = [
    ("SHADE_FN float f(float a, vec3 b) { return a; }", ["f"]),
    ("// SHADE_FN float f(float a) { return a; }\nSHADE_FN\nbool\ng(\n  mat3 m,\n  int i)\n{ return true; }", ["g"]),
    ("#ifdef __cplusplus\nfloat h();\nSHADE_FN float f(vec2 uv);\n#else\nSHADE_FN float f(vec2 p) { return 0.0f; }\n#endif",
     ["f"]),
    ("#ifdef __cplusplus\nSHADE_FN float only_here(std::array<int, 3>& a);\n#endif", Refusal),
    ("#ifndef __cplusplus\nSHADE_FN float only_here(vec3 a) { return a.x; }\n#endif", []),
    ("struct S { vec3 a, b; float c[kN]; };\nSHADE_CONST int kN = 3;\nSHADE_FN S f(S s) { return s; }", ["f"]),
    ("SHADE_FN float f(float a);\nSHADE_FN float f(float a) { return a; }\nSHADE_FN float f(vec3 a) { return a.x; }",
     ["f_float", "f_vec3"]),
    ("SHADE_FN float f(Unknown u) { return 0.0f; }", Refusal),
    ("struct S { float a; };\nSHADE_FN float f(SHADE_IN(S) s, vec3 w) { return s.a; }", ["f"]),
    ("struct S { float a; };\nSHADE_FN void f(SHADE_IN(S) s, SHADE_INOUT(S) t);\nSHADE_FN int g(SHADE_INOUT(S) t);",
     ["f", "g"]),
    ("struct S { float a; };\nSHADE_FN void f(SHADE_IN(S) s) { }", Refusal),
    ("SHADE_FN float f(SHADE_OUT(float) a) { return a; }", Refusal),
    ("SHADE_FN float f(inout float a) { return a; }", Refusal),
    ("SHADE_FN constexpr float f(float a) { return a; }", Refusal),
    ("struct S { float c[kUnknown]; };", Refusal),
]


# Text that the statements of a planted header must hold.
PLANTED_STATEMENTS = [
    ("struct S { float a; };\nSHADE_FN int f(SHADE_IN(S) s, SHADE_INOUT(S) t);",
     ["int r = f(a0, a1);", "y[0] = float(r);", "y[1] = a1.a;"]),
    ("struct Surface { int lobes; float coat_alpha; };\nSHADE_FN void f(SHADE_INOUT(Surface) s);",
     ["  f(a0);", "y[0] = float(a0.lobes);", f"y[1] = (a0.lobes & kLobeClearcoat) != 0 ? a0.coat_alpha : {ABSENT};"]),
]


def generate_planted(text):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "shade").mkdir()
        (root / "shade/planted.glsl.h").write_text(text, encoding="utf-8")
        return generate(root)


def self_test():
    for text, expected in PLANTED:
        try:
            found = re.findall(r'^    {"(\w+)", "shade/', generate_planted(text), re.MULTILINE)
        except Refusal as refusal:
            found = Refusal if str(refusal).startswith("shade/planted.glsl.h:") else str(refusal)
        if found != expected:
            sys.exit(f"self-test: {text!r}: expected {expected}, found {found}")
    for text, expected in PLANTED_STATEMENTS:
        missing = [statement for statement in expected if statement not in generate_planted(text)]
        if missing:
            sys.exit(f"self-test: {text!r}: not found: {missing}")
    print(f"{len(PLANTED) + len(PLANTED_STATEMENTS)} planted headers read as they should be")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        text = generate(pathlib.Path(sys.argv[1]))
    except Refusal as refusal:
        sys.exit(f"generate.py: {refusal}")
    pathlib.Path(sys.argv[2]).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
