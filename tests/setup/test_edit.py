"""One key changed in a study's text: what it then says, and that every other line is as it was."""

import tomllib
from copy import deepcopy
from difflib import SequenceMatcher
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.errors import InputError
from faying.setup.edit import edited, parsed, statements, written
from faying.setup.template import TEXT

STUDY = TEXT.format(name="study.toml", step="two-blocks.step", scan="surface.x3p")
EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*/*.toml"))
TEXTS = [STUDY, *(path.read_text() for path in EXAMPLES)]


def leaves(data, path=()):
    """Every value of a study that is not a table, by its path."""
    if isinstance(data, dict):
        for name, inner in data.items():
            yield from leaves(inner, (*path, name))
    elif isinstance(data, list) and data and all(isinstance(one, dict) for one in data):
        for k, inner in enumerate(data):
            yield from leaves(inner, (*path, k))
    else:
        yield path


def with_value(data, path, value):
    """Independent of `edited`: the tree with one value set."""
    out = deepcopy(data)
    at = out
    for one in path[:-1]:
        at = at[one]
    at[path[-1]] = value
    return out


def changed_lines(before, after):
    """Lines of the old text that are gone, and lines of the new one that came."""
    a, b = before.splitlines(keepends=True), after.splitlines(keepends=True)
    gone, came = [], []
    for kind, i, j, k, m in SequenceMatcher(None, a, b, autojunk=False).get_opcodes():
        if kind != "equal":
            gone += a[i:j]
            came += b[k:m]
    return gone, came


@pytest.mark.parametrize(
    ("path", "value", "gone", "came"),
    [
        (
            ("geometry", "size"),
            "6 mm",
            ['size = "8 mm"                  # largest element\n'],
            ['size = "6 mm"                  # largest element\n'],
        ),
        (
            ("geometry", "face_size", "upper.joint"),
            "3 mm",
            ['"upper.joint" = "4 mm"\n'],
            ['"upper.joint" = "3 mm"\n'],
        ),
        (("geometry", "face_size", "lower.joint"), "3 mm", [], ['"lower.joint" = "3 mm"\n']),
        (("bolt", 0, "diameter"), "8 mm", [], ['diameter = "8 mm"\n']),
        (
            ("bolt", 0, "preload"),
            "9 kN",
            ['preload = ["8 kN", "15 kN"]            # one or more, in turn\n'],
            ['preload = "9 kN"            # one or more, in turn\n'],
        ),
        (("modes", "intervals"), False, [], ["intervals = false\n"]),
        (("surface", "counter"), None, [next(x for x in STUDY.splitlines(True) if x.startswith("counter"))], []),
        (("joint", 0, "form", "flatness"), "5 um", [], ["[joint.form]\n", 'flatness = "5 um"\n', "\n"]),
        (("support", 0), {"face": "lower.joint"}, [], ["\n", "[[support]]\n", 'face = "lower.joint"\n']),
        (("material", "my steel", "nu"), 0.3, [], ["\n", '[material."my steel"]\n', "nu = 0.3\n"]),
        (
            ("uncertain", "joint.friction"),
            "0.1 to 0.6",
            [],
            ["\n", "[uncertain]\n", '"joint.friction" = "0.1 to 0.6"\n'],
        ),
    ],
)
def test_one_line_of_the_template_changes(path, value, gone, came):
    assert changed_lines(STUDY, edited(STUDY, path, value)) == (gone, came)


def test_a_new_bolt_stands_behind_the_others_and_what_describes_them():
    text = edited(STUDY, ("bolt", 1), {"name": "second", "preload": "3 kN"})
    assert text.index('# grade = "8.8"') < text.index('name = "second"') < text.index("[modes]")
    assert '\n\n[[bolt]]\nname = "second"\npreload = "3 kN"\n\n[modes]' in text


def test_a_table_is_taken_out_with_what_lies_in_it():
    text = '[[bolt]]\nname = "a"\n[[bolt.washer]]\nouter = "1 mm"\n# of b\n[[bolt]]\nname = "b"\n[modes]\ncount = 3\n'
    assert edited(text, ("bolt", 0), None) == '# of b\n[[bolt]]\nname = "b"\n[modes]\ncount = 3\n'


@pytest.mark.parametrize(
    ("text", "path", "value", "new"),
    [
        ("a = 1", ("b",), 2, "a = 1\nb = 2\n"),
        ("", ("b",), "x", 'b = "x"\n'),
        ("# head\n\n[a]\nx = 1\n", ("title",), "t", '# head\ntitle = "t"\n\n[a]\nx = 1\n'),
        ("[a]\r\nx = 1 # one\r\n[b]\r\n", ("a", "y"), 2, "[a]\r\nx = 1 # one\r\ny = 2\r\n[b]\r\n"),
        ("[a]\n  x = 1\n", ("a", "y"), 2, "[a]\n  x = 1\n  y = 2\n"),
        ("[a] # c\n", ("a", "y"), 2, "[a] # c\ny = 2\n"),
        ("x = 1  # ASSUMED: class 8.8\r\ny = 2  # ASSUMED\r\n", ("x",), 3, "x = 3\r\ny = 2  # ASSUMED\r\n"),
        ("x = 1  # drawn: a nut\n", ("x",), 3, "x = 3\n"),
        ("x = 1  # 4,764 mm2, 0.1 mm apart\n", ("x",), 3, "x = 3\n"),
        ("x = 1  # drawn on the left\n", ("x",), 3, "x = 3  # drawn on the left\n"),
        ("x = 1  # 12 mm2 by hand\n", ("x",), 3, "x = 3  # 12 mm2 by hand\n"),
        ('x = 1  # see "# ASSUMED"\n', ("x",), 3, 'x = 3  # see "# ASSUMED"\n'),
        ("x = 1  # largest element: about 28,000 unknowns\n", ("x",), 3, "x = 3  # largest element\n"),
        ('f = ["a", "b"]  # 3521 mm2, 50 um apart\n', ("f",), ["a", "c"], 'f = ["a", "c"]\n'),
        ("x = 1  # by hand, of 12 mm2\n", ("x",), 3, "x = 3  # by hand, of 12 mm2\n"),
        ("m.count = 3\n[b]\n", ("m", "solver"), "x", 'm.count = 3\nm.solver = "x"\n[b]\n'),
        ("[u]\nj.f = 1\n", ("u", "j", "g"), 2, "[u]\nj.f = 1\nj.g = 2\n"),
        ("[u]\nj.f = 1\n", ("u", "j", "f"), None, "[u]\n"),
        ('f = { p = "a", n = [1,\n 2] } # c\n', ("f", "n"), None, 'f = { p = "a" } # c\n'),
        ("b = [{n = 1}, {n = 2}]\n", ("b", 1, "n"), 3, "b = [{ n = 1 }, { n = 3 }]\n"),
        ("[part.a]\nm = 1\n\n[z]\n", ("part", "b", "m"), 2, "[part.a]\nm = 1\n\n[part.b]\nm = 2\n\n[z]\n"),
        ("[part.a]\nm = 1\n", ("part", "a"), None, ""),
        ("[[s]]\na = 1\n", ("s", 0), None, ""),
        ("# d\n\n# of s,\n# by hand\n[[s]]\na = 1\n# e\n", ("s", 0), None, "# d\n\n# e\n"),
        ('s = """\n[a]\n# no"""  # c\n[a]\n', ("a", "k"), True, 's = """\n[a]\n# no"""  # c\n[a]\nk = true\n'),
        ('k = "#"#c\n', ("k",), 'b"\\\n\x7f', 'k = "b\\"\\\\\\n\\u007f"#c\n'),
        ('"a\\u0062" = 1\n', ("ab",), 2, '"a\\u0062" = 2\n'),
    ],
)
def test_the_text_is_exactly(text, path, value, new):
    assert edited(text, path, value) == new


@pytest.mark.parametrize(
    ("text", "path", "value", "said"),
    [
        ("a = ", ("a",), 1, "not TOML"),
        ("[bolt]\nname = 'b'\n", ("bolt", 1), {}, r"bolt\[2\] has no place"),
        ("[[bolt]]\n", ("bolt", 5, "x"), 1, r"bolt\[6\]\.x has no place"),
        ("a = 1\n", ("a", "b"), 1, "a.b has no place"),
        ("a = 1\n", ("b",), None, "b is not in the text"),
        ("a = 1\n", ("a",), "\ud800", "cannot be changed alone"),
    ],
)
def test_what_cannot_be_done_is_said(text, path, value, said):
    with pytest.raises(InputError, match=said):
        edited(text, path, value)


values = st.one_of(
    st.text(max_size=12),
    st.integers(-(2**53), 2**53),
    st.floats(allow_nan=False),
    st.booleans(),
    st.lists(st.text(max_size=5), max_size=3),
)


@given(st.data())
@settings(max_examples=50, deadline=None)
def test_any_value_of_any_example_changes_alone(data):
    """parse(edit(text)) == edited(parse(text)), and only lines of that one statement change."""
    text = data.draw(st.sampled_from(TEXTS))
    before = tomllib.loads(text)
    path = data.draw(st.sampled_from(list(leaves(before))))
    value = data.draw(values)
    new = edited(text, path, value)
    assert tomllib.loads(new) == with_value(before, path, value)
    one = next(one for one in statements(text) if not one.is_head and one.path == path[: len(one.path)])
    assert new.startswith(text[: one.value])
    assert new.endswith(text[one.value_end :])


@given(st.data())
@settings(max_examples=50, deadline=None)
def test_a_key_put_in_and_taken_out_leaves_the_text(data):
    text = data.draw(st.sampled_from(TEXTS))
    before = tomllib.loads(text)
    path = data.draw(st.sampled_from(list(leaves(before))))
    name = data.draw(st.text(max_size=6).filter(lambda one: one not in {"", *map(str, path)}))
    inner = (*path[:-1], name)
    table = before
    for one in path[:-1]:
        table = table[one]
    if name in table:
        return
    value = data.draw(values)
    new = edited(text, inner, value)
    assert tomllib.loads(new) == with_value(before, inner, value)
    old = set(text.splitlines())
    one = next(one for one in statements(text) if not one.is_head and one.path == path[: len(one.path)])
    if one.path == path:  # no inline table, which is written anew
        assert old <= set(new.splitlines())
        assert edited(new, inner, None) == text


KEYS = st.sampled_from(["a", "b", '"c.d"', "'e f'", "g-h"])
ATOMS = st.sampled_from(
    ['"x#y"', "'[z]'", "1", "2.5", "true", '["p", # c = 1\n "q"]', "{ k = 1, l = [2] }", '"""m\n[n]"""']
)
COMMENTS = st.sampled_from(["", "# note", " # = [x]", "  "])


@st.composite
def texts(draw):
    """Small texts with comments, dotted keys, tables, lists of tables, line ends of both kinds."""
    lines = []
    for _ in range(draw(st.integers(1, 7))):
        kind = draw(st.integers(0, 5))
        key = ".".join(draw(st.lists(KEYS, min_size=1, max_size=2)))
        if kind == 0:
            lines.append(f"[{key}]{draw(COMMENTS)}")
        elif kind == 1:
            lines.append(f"[[{key}]]{draw(COMMENTS)}")
        elif kind == 2:
            lines.append(draw(COMMENTS).strip())
        else:
            lines.append(f"{draw(st.sampled_from(['', '  ']))}{key} = {draw(ATOMS)}{draw(COMMENTS)}")
    end = draw(st.sampled_from(["\n", "\r\n"]))
    text = "\n".join(lines).replace("\n", end) + draw(st.sampled_from(["", end]))
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return ""
    return text


@given(texts(), st.data())
@settings(max_examples=150, deadline=None)
def test_small_texts_of_every_form(text, data):
    """What is returned is right by the check within; nothing that has its place in the text is refused."""
    before = parsed(text)
    paths = list(leaves(before))
    if not paths:
        return
    path = data.draw(st.sampled_from(paths))
    value = data.draw(st.sampled_from(["new", 3, None, ["u", "v"], {"w": 1}]))
    new = edited(text, path, value)
    if value is not None:
        assert tomllib.loads(new) == with_value(before, path, value)
    sibling = (*path[:-1], "new key")
    assert tomllib.loads(edited(text, sibling, 1)) == with_value(before, sibling, 1)


@given(st.recursive(values, lambda inner: st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=6))
def test_what_is_written_reads_as_it_was(value):
    assert tomllib.loads(f"a = {written(value)}")["a"] == value
