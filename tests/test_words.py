"""Words of docs and messages: one word for one thing, short sentences, no history of the making, decimals with a zero.

Code, inline code and links are not prose and are taken out first. Each pattern is followed by what to write instead.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SITE = ROOT / "docs" / "_build"
DOCS = sorted(p for p in (ROOT / "docs").rglob("*.md") if SITE not in p.parents)
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *DOCS]
SOURCES = sorted((ROOT / "src" / "faying").rglob("*.py"))
NOT_TEXT = {"output/page.py", "output/scene/pages.py"}  # style sheets
LINTED = [pytest.param(page, id=str(page.relative_to(ROOT))) for page in PAGES]

# pattern of a word that needs its author: what to write instead
PRIVATE = {
    r"besides?": "with, next to, compared with, against",
    r"told": "printed, noted, known",
    r"whole(?! number)": "full, entire, complete",
    r"kept": "saved, cached, held",
    r"mends?|mended": "corrects, reduces",
    r"ladder|rungs?": "pressure series, level",
    r"grips?": "sticks",
    r"grown together": "bonded",
    r"closed laws?": "analytic law",
    r"that which": "what, or a noun",
    r"lies? off": "does not follow",
}
# what tells of the making and not of the product
HISTORY = {
    r"used to": "say what is so now",
    r"no longer(?! side)": "say what is so now",
    r"yesterday|another day|on its day|this hour": "leave the day out",
    r"before (?:this|these changes|that change)": "say what is so now",
    r"earlier (?:run|state)s?": "say what is so now",
    r"(?:as|than|what it was) before": "say what is so now",
    r"today|nowadays|until now|by now": "say what is so now",
    r"formerly|previously|newly": "say what is so now",
    r"tried and (?:left|dropped|taken back)": "leave it out",
    r"not measured since": "measure it, or leave it out",
    r"(?:quieter|slower|faster) machine": "leave the machine out",
}
MOST_WORDS = 30  # of a sentence
# what belongs to one machine or one day; /usr/bin is on every one
PLACES = {
    r"(?<![\w.])/(?:work|home|root|tmp|Users)/[\w.]": "a path of one machine",
    r"[A-Z]:\\Users": "a path of one machine",
    r"\b20\d\d-\d\d-\d\d\b": "a date",
    r"\b(?:Mon|Tues|Wednes|Thurs|Fri|Satur|Sun)day\b": "a day",
}
# a message may say that a file is no longer there
IN_MESSAGES = PLACES | {p: PRIVATE[p] for p in (r"grown together", r"closed laws?", r"that which", r"lies? off")}
# "x is no mode" is read twice; there may be no mode, and a file that is no longer there
IN_MESSAGES[r"(?<!here )\b(?:is|are|was|were) no (?!longer)"] = "is not a"
# a decimal without its zero: .31, -.4, (.5; not 1.5, ".3f", [.., x.5 or the end of a range 1..5
DECIMAL = re.compile(r"(?<![\w.)\]/*:}\\])(?<!:[-+<>^ ,])\.(?=\d)(?!\d+[fgdeE%](?![-+\d]))")


def prose(page: str) -> str:
    """A page with all that is not prose blanked, line by line, so that numbers of lines stay."""
    out, fence = [], ""
    for line in page.splitlines():
        mark = re.match(r"\s*(`{3,}|:{3,})", line)
        if fence or (mark and not fence):
            if mark and not fence:
                fence = mark.group(1)
            elif line.strip() == fence:
                fence = ""
            out.append("")
            continue
        line = re.sub(r"`[^`]*`", "``", line)
        line = re.sub(r"\]\([^)]*\)|\{[a-z]+\}``|https?://\S+|doi:(?:[^\s()]|\([^\s()]*\))+", "]", line)
        out.append(line)
    return "\n".join(out)


def paragraphs(page: str) -> Iterator[tuple[int, str]]:
    """First line and text of each paragraph and item of a list; tables, headings and equations apart are none."""
    start, text, equation = 0, "", False
    for number, line in enumerate([*prose(page).splitlines(), ""], 1):
        apart = line.strip() == "$$"
        item = re.match(r"\s*(?:[-*]|\d+\.) ", line)
        if text and (apart or equation or item or re.match(r"\s*(?:$|\||#|<!--|!\[|\]$)", line)):
            yield start, text
            text = ""
        equation = equation != apart
        if equation or apart or re.match(r"\s*(?:$|\||#|<!--|!\[)", line):
            continue
        start, text = (start, f"{text} {line.strip()}") if text else (number, line.strip())


def long_sentences(page: str) -> Iterator[tuple[int, int, str]]:
    """Line of the paragraph, number of words and text of each sentence that is too long.

    A colon or semicolon before a capital letter ends one, too. Links and sources in brackets, inline equations and
    numbers are not words.
    """
    for line, text in paragraphs(page):
        plain = re.sub(r"\$[^$]*\$", "$", text)
        plain = re.sub(r"\([^()]*\][^()]*\)", "", plain)
        for sentence in re.split(r"(?<=[.!?:;])[\"*_)]*\s+(?=[A-Z\[*(`\"_$])", plain):
            words = sum(bool(re.search(r"[A-Za-z]", word)) for word in sentence.split())
            if words > MOST_WORDS:
                yield line, words, sentence


def found(patterns: dict[str, str], text: str) -> Iterator[tuple[int, str]]:
    """Line and message of each pattern in a text."""
    for pattern, better in patterns.items():
        words = (
            pattern if "\\" in pattern[:3] or pattern.startswith("(") or pattern[0] == "[" else rf"\b(?:{pattern})\b"
        )
        for hit in re.finditer(words, text, re.IGNORECASE):
            yield text.count("\n", 0, hit.start()) + 1, f"{hit.group()!r}: {better}"


def texts(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of every string of a module that has a space; each value in an f-string reads {}."""
    seen: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.JoinedStr):
            seen |= {id(inner) for value in node.values for inner in ast.walk(value)}
            text = "".join(str(v.value) if isinstance(v, ast.Constant) else "{}" for v in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in seen:
            text = node.value
        else:
            continue
        if " " in text:
            yield node.lineno, text


@pytest.mark.parametrize("page", LINTED)
def test_a_page_has_the_words_of_the_field_and_no_history(page):
    text = prose(page.read_text(encoding="utf-8"))
    faults = [f"{page.name}:{line}: {said}" for line, said in found(PRIVATE | HISTORY | PLACES, text)]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize("page", LINTED)
def test_sentences_of_a_page_are_short(page):
    """Most readers have another first language: one thought a sentence."""
    long = long_sentences(page.read_text(encoding="utf-8"))
    faults = [f"{page.name}:{line}: {words} words: {sentence}" for line, words, sentence in long]
    assert not faults, f"write sentences of {MOST_WORDS} words at most\n" + "\n".join(faults)


def test_a_decision_is_half_a_page():
    long = {p.name: n for p in PAGES if p.parent.name == "decisions" and (n := len(p.read_text().splitlines())) > 30}
    assert not long


def test_the_readme_and_the_changes_are_short():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) < 80
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    latest = changes.split("\n## ")[1]
    assert re.findall(r"^### (.*)", latest, re.M)[0] == "Numbers that changed"
    assert len(latest.split()) <= 1500


@pytest.mark.parametrize("page", LINTED)
def test_decimals_of_a_page_have_their_zero(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    faults = [f"{page.name}:{k}: {line.strip()[:90]}" for k, line in enumerate(lines, 1) if DECIMAL.search(line)]
    assert not faults, "write 0.31 for .31\n" + "\n".join(faults)


@pytest.fixture(scope="module")
def messages():
    """File, line and text of each string of the source."""
    return [(path, *one) for path in SOURCES for one in texts(path.read_text(encoding="utf-8"))]


def test_decimals_of_messages_and_docstrings_have_their_zero(messages):
    faults = [
        f"{path.relative_to(ROOT)}:{line}: {text.strip()[:90]}"
        for path, line, text in messages
        if path.relative_to(ROOT / "src" / "faying").as_posix() not in NOT_TEXT and DECIMAL.search(text)
    ]
    assert not faults, "write 0.31 for .31\n" + "\n".join(faults)


def test_messages_have_no_private_words_and_no_path_of_a_machine(messages):
    faults = [
        f"{path.relative_to(ROOT)}:{line}: {said}"
        for path, line, text in messages
        for _, said in found(IN_MESSAGES, text)
    ]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("modes beside the test", "'beside'"),
        ("The Whole map is at hardness", "'Whole'"),
        ("faces grown together", "'grown together'"),
        ("it took 51 s on another day", "'another day'"),
        ("as it used to be", "'used to'"),
        ("the same numbers as before", "'as before'"),
        ("Today it is one room", "'Today'"),
        ("written to /home/x/results", "'/home/x'"),
        ("measured on 2025-01-31", "'2025-01-31'"),
    ],
)
def test_the_lint_finds_what_it_is_for(text, said):
    assert [message.split(":")[0] for _, message in found(PRIVATE | HISTORY | PLACES, text)] == [said]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("type 5, which is no mode", "'is no '"),
        ("3 lines are no numbers", "'are no '"),
        ("there is no mode", None),
        ("There are no modes below", None),
        ("the file is no longer there", None),
    ],
)
def test_a_message_says_what_is_not_so_in_the_common_order(text, said):
    assert [message.split(":")[0] for _, message in found(IN_MESSAGES, text)] == ([said] if said else [])


SENTENCE = " ".join(["word"] * 16)


@pytest.mark.parametrize(
    ("text", "lengths"),
    [
        (f"A {SENTENCE} {SENTENCE}.", [33]),
        (f"A {SENTENCE}\n{SENTENCE}.\nOne more.", [33]),  # over lines
        (f"- A {SENTENCE}, {SENTENCE}\n- B {SENTENCE}", [33]),
        (f"A {SENTENCE}. B {SENTENCE}: C {SENTENCE}; D {SENTENCE}! `x` {SENTENCE}", []),
        (f"- A {SENTENCE}\n- B {SENTENCE}", []),
        (f"| A {SENTENCE} {SENTENCE} |", []),
        (f"A {SENTENCE}\n\n$$\nx {SENTENCE}\n$$\n\nwith {SENTENCE}", []),
        (f"A {SENTENCE} ({SENTENCE}, doi:10.1/x) {SENTENCE[:39]}", []),
        (f"A {SENTENCE} {'1.5 ' * 20}", []),
    ],
)
def test_the_lint_counts_the_words_of_a_sentence(text, lengths):
    assert [words for _, words, _ in long_sentences(text)] == lengths


def test_the_lint_leaves_code_and_plain_words_alone():
    page = "a whole number, `[[beside]]`\n```sh\nfaying run --beside /tmp/x\n```\n[a page](beside.md), /usr/bin/python3"
    assert not list(found(PRIVATE | HISTORY | PLACES, prose(page)))
    assert prose("a\n```\nb\n```\nc") == "a\n\n\n\nc"  # numbers of lines stay


@pytest.mark.parametrize("text", ["falls by .31 %", "(.5, .9)", "-.4", "| .04 |", "+- .04", "p/E* .01", "1 .. .5"])
def test_a_decimal_without_zero_is_found(text):
    assert DECIMAL.search(text)


@pytest.mark.parametrize(
    "text", ["0.31", "1.5e-3", "3..5", "x.5", "{x:.3g}", "{x:+.2%}", '".3f"', "v1.2", "d).5", "file.3mf"]
)
def test_other_points_are_left_alone(text):
    assert not DECIMAL.search(text)
