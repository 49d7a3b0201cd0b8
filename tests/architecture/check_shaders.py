#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tests/architecture/check_shaders.py [FILE...]: shaders keep to the subset of GLSL that docs/gl.md names.

Drivers have compilers of their own, and Mesa's takes what others refuse. Each rule below has an example that breaks it,
which the rule must find, so that none is blind. Without FILE the shaders of render/shaders/ and those in the C code of
bench/ are read, and the rules for C code and tests that belong to shaders are checked, too.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADERS = ROOT / "render" / "shaders"
AFTER = {"colour_layers.glsl": "colour.frag.glsl"}  # which files a second one follows; all follow common.glsl

TYPE = r"(?:void|bool|int|uint|float|double|[biud]?vec[234]|d?mat[234](?:x[234])?|[iu]?(?:sampler|image)\w+)"
BUILT_IN = set("""abs acos all any asin atan ceil clamp cos cross degrees determinant distance dot equal exp exp2 floor
    fma fract inverse inversesqrt isinf isnan length log log2 max min mix mod modf normalize not outerProduct pow
    radians reflect refract round sign sin smoothstep sqrt step tan texture transpose trunc""".split())

# Words, pattern, example; where only some files are meant, a name of them.
PATTERNS = [
    ("versions and extensions are chosen in render/gl/program.c", r"#\s*(?:version|extension)", "#extension all : warn", ""),
    ("a sampler or an image is not in an array", r"\b[iu]?(?:sampler|image)\w+\s+\w+\s*\[", "uniform sampler3D fields[4];",
     ""),
    ("an array is made by a constructor, uint[](1u, 2u)", r"=\s*\{", "uint pair[2] = { 1u, 2u };", ""),
    ("an array is no constant: compilers copy it for each index", r"\bconst\s+\w+\s+\w+\s*\[|\bconst\s+\w+\s*\[\]",
     "const float steps[2] = float[](0.0, 1.0);", ""),
    ("doubles do not pass from stage to stage", r"\b(?:in|out)\s+d(?:ouble|vec|mat)\w*\s+\w+;", "flat out dvec3 place;", ""),
    ("fma() may round twice, or once", r"\bfma\s*\(", "precise double t = fma(a, b, c);", ""),
    ("what is not rounded alike everywhere comes from the CPU: no division, root or function of angles",
     r"/|(?<!\.)\b(?:sqrt|inversesqrt|normalize|length|distance|inverse|sin|cos|tan|exp2?|log2?|pow)\s*\(", "dvec3 i = 1.0 / d;",
     "/id.frag.glsl"),
]

# The same for other sources: words, pattern, example, which files, which of them may.
SOURCES = [
    ("buffers are not declared for reading by the CPU: drivers keep them in its memory, and shaders write there",
     r"GL_(?:STREAM|STATIC|DYNAMIC)_READ\b", "glNamedBufferData(b, 4, NULL, GL_STREAM_READ);", "render/**/*.c", ""),
    ("a test is skipped by test_need_gl() or assert_gl(), not for CONUS_ERROR_GL: a driver may refuse a shader",
     r"CONUS_ERROR_GL\)[^}]*(?:skip\(\)|return;)", 'if (status == CONUS_ERROR_GL) { print_message("x"); skip(); }',
     "tests/**/*.c", "tests/bench/test_peers.c"),  # VTK's contexts, not ours
    ("a test is skipped by need_gl, not for exit code 4: a driver may refuse a shader",
     r"-ne 4 \] \|\| skip|-eq 4 \] \|\||\$\? -?(?:eq|=) 4 \]|\$\? = 4 \]", '[ "$status" -ne 4 ] || skip "no OpenGL"',
     "tests/**/*.ba[ts]*", ""),
    ("a test is skipped by $CONUS_HAS_GL, not for a GLError: a driver may refuse a shader",
     r"except conus\.GLError[^\n]*\n\s*pytest\.skip", "except conus.GLError as error:\n    pytest.skip()",
     "tests/python/*.py", ""),
]

INDEXED = [
    "void main() { dvec3 cell; for (int axis = 0; axis < 3; axis++) { cell[axis] = 0.0lf; } }",
    "uniform vec3 corners[4]; void main() { int k = 2; float x = corners[k][k]; }",
    "int order[3]; void main() { dvec3 cell; int k = 2; double x = cell[order[k]]; }",
    "struct Place { dvec3 cell; }; void main() { Place at; int k = 1; at.cell[k] = 1.0lf; }",
    "void main() { dmat3 m = dmat3(1.0lf); int k = 2; m[k].x = 1.0lf; }",
    "void main() { int k = 2; float x = vec3(1, 2, 3)[k]; }",
]
HIDDEN = ["void main() { double sign = 1.0lf; }", "void main() { dvec3 origin = dvec3(0), inverse = dvec3(1); }"]
OPEN = ["float half_of(float x)\n{\n    if (x > 0.0) {\n        return 0.5 * x;\n    }\n}\n"]
RIGHT = """uniform vec3 ramp[STEPS + 1], last; // columns[k]
struct Found { uint id, cell[3]; };
float at(vec4 v, int k)
{
    const int LAST = 2;
    uint cells[3] = uint[](1u, 2u, 3u);
    return v.x + v[0] + v[LAST] + ramp[k + int(cells[k % 3])].x;
}
"""


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.S)


def declarations(code):
    """Each variable, member and parameter: its name, what it is (array, vector, plain), and where it stands."""
    types = "|".join([TYPE, *re.findall(r"\bstruct (\w+)", code)])
    for start in re.finditer(rf"\b({types})\s+(?=\w)(?!\w+\s*\()", code):
        depth, begins = 0, [start.end()]
        for at in range(start.end(), len(code)):
            depth += (code[at] in "([") - (code[at] in ")]")
            if depth < 0 or code[at] in ";{":
                break
            if code[at] == "," and depth == 0:
                begins.append(at + 1)
        for at in begins:
            name = re.compile(r"\s*(\w+)\s*(\[)?").match(code, at)
            if name:
                kind = "array" if name[2] else "vector" if re.match("[biud]?vec|d?mat", start[1]) else "plain"
                yield name[1], kind, name.start(1)


def indexed_by_variables(code):
    """Where something that is not surely an array has an index that varies."""
    kinds = {}
    for name, kind, _ in declarations(code):
        kinds.setdefault(name, set()).add(kind)
    for match in re.finditer(r"\[", code):
        depth, end = 1, match.end()
        while depth and end < len(code):
            depth += (code[end] == "[") - (code[end] == "]")
            end += 1
        base = re.search(r"(\w*)\s*$", code[:match.start()])[1]
        if not re.fullmatch(r"[A-Z0-9_u\s+*-]*\]", code[match.end():end]) and kinds.get(base) != {"array"}:
            yield match.start()


def hidden(code):
    """Where a variable is declared under the name of a function. A member may have one."""
    code = re.sub(r"\bstruct \w+\s*\{[^}]*\}", lambda m: re.sub(r"[^\n]", " ", m[0]), code)
    functions = BUILT_IN | set(re.findall(r"^\w+ (\w+)\(", code, re.M))
    yield from sorted({at for name, _, at in declarations(code) if name in functions})


def without_return(code):
    """Functions whose last statement is not a return."""
    for match in re.finditer(r"^(?!void\b)\w+ \w+\([^)]*\)\n\{\n(.*?)^\}", code, re.M | re.S):
        last = re.findall(r"^    \S.*", match[1], re.M)
        if not last or not last[-1].startswith("    return"):
            yield match.start()


ANALYSES = [
    ("only arrays are indexed by what varies: a component is a name, .x", indexed_by_variables, INDEXED),
    ("a variable has not the name of a function", hidden, HIDDEN),
    ("a function that returns something ends with return", without_return, OPEN),
]


def findings(name, text, before=""):
    code = without_comments(text)
    before = without_comments(before)
    for words, pattern, _, only in PATTERNS:
        if not only or name.endswith(only):
            yield from ((match.start(), words) for match in re.finditer(pattern, code))
    for words, analysis, _ in ANALYSES:
        yield from ((at - len(before), words) for at in analysis(before + code) if at >= len(before))


def line_of(text, at):
    return text.count("\n", 0, at) + 1


def shaders_in_c(path):
    """Strings of C code that are whole shaders."""
    text = path.read_text(encoding="utf-8")
    for name, literal in re.findall(r'char (\w+)\[\] = ((?:\s*"(?:[^"\\]|\\.)*")+);', text):
        shader = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', literal)).replace("\\n", "\n")
        if "void main()" in shader:
            yield f"{path.relative_to(ROOT)}: {name}", shader


def all_shaders():
    texts = {path.name: path.read_text(encoding="utf-8") for path in sorted(SHADERS.glob("*.glsl"))}
    for name, text in texts.items():
        before = [] if name == "common.glsl" else ["common.glsl", AFTER.get(name)]
        yield f"render/shaders/{name}", text, "".join(texts[other] for other in before if other)
    for path in sorted((ROOT / "bench").rglob("*.c")):
        yield from ((name, shader, "") for name, shader in shaders_in_c(path))


def check_examples():
    """Each rule finds its own examples, and none what is right."""
    for words, pattern, example, only in PATTERNS:
        assert words in [said for _, said in findings(only or "x.frag.glsl", example)], (words, pattern)
    for words, _, examples in ANALYSES:
        for example in examples:
            assert words in [said for _, said in findings("x.frag.glsl", example)], example
    assert not list(findings("x.frag.glsl", RIGHT)), list(findings("x.frag.glsl", RIGHT))
    for words, pattern, example, *_ in SOURCES:
        assert re.search(pattern, example), words


def check_sources():
    count = 0
    for words, pattern, _, files, excepted in SOURCES:
        for path in sorted(ROOT.glob(files)):
            text = path.read_text(encoding="utf-8", errors="replace")
            for match in re.finditer(pattern, text) if str(path.relative_to(ROOT)) != excepted else ():
                print(f"{path.relative_to(ROOT)}:{line_of(text, match.start())}: {words}")
                count += 1
    return count


def main():
    check_examples()
    given = [(name, pathlib.Path(name).read_text(encoding="utf-8"), "") for name in sys.argv[1:]]
    shaders = given or list(all_shaders())
    assert given or len(shaders) >= 15, shaders
    count = 0 if given else check_sources()
    for name, text, before in shaders:
        for at, words in sorted(findings(name, text, before)):
            print(f"{name}:{line_of(text, at)}: {words}")
            count += 1
    sys.exit(1 if count else 0)


if __name__ == "__main__":
    main()
