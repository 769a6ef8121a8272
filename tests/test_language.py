"""Pages, help texts, report templates, docstrings and comments use the established terms.

The project once had words of its own, such as "mend" for fix and "told" for reported. Each entry of
`PRIVATE` is a pattern that finds one of them, with the term to write instead. The patterns are
narrow on purpose: "bar" finds a bar of residuals, and not a bar in tension.
"""

import ast
import io
import re
import tokenize

import click
import pytest

from lacore_verification.commands import cli
from lacore_verification.report.problems import starters
from tests.conftest import ROOT

PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "lacore").glob("*.txt")),
    *sorted((ROOT / "verification" / "lacore_verification" / "report").glob("*.j2")),
]
LACORE, VERIFICATION = ROOT / "lacore", ROOT / "verification" / "lacore_verification"
PACKAGES = [
    ROOT / "backends" / "lacore_backends",
    *(file.parent for file in sorted(LACORE.glob("*/__init__.py"))),
    *(file.parent for file in sorted(VERIFICATION.glob("*/__init__.py"))),
]
ITEM = "line|page|row|process|card|picture|solve|table|step|test|file"
PRIVATE = {
    r"fit backends?\b": "applicable backends",
    r"what (it|each|he|they|a backend|backends?) takes?\b": "supported",
    r"how (it|they|these|those|each|the [\w ]{3,20}|an? \w+) (alone )?falls?\b(?! with)": (
        "collapse mechanism"
    ),
    r"(structure|wall|arch|dome|block|frame|slope|vault|pier|bridge|building)s? (falls?|fell)\b": (
        "collapses"
    ),
    r"stands? or falls?\b": "stands or collapses",
    r"dilates? less\b": "non-associated flow (dilation angle smaller than the friction angle)",
    r"mend(s|ed|ing)?\b": "fix",
    r"told\b(?! (apart|users?)\b)": "reported",
    r"said\b(?! to be\b)": "reported, stated",
    r"(by|with|in) a word\b|a word, (locked|unsafe|free)\b|words are proven\b": "message",
    r"what (it|they|that|this|an?|the|is|are|each|one)\b[^.;:|?]{0,60}\bworth\b": (
        "what the value proves, rigour"
    ),
    r"(go|goes|going|went|gone) on\b": "continue",
    r"comes? to (?!rest\b|an end\b|mind\b|lie\b)": "reach, converge to",
    r"(loop|iteration|solve|solver|scheme|sequence|factor|residual|value|it)s? settles?\b": (
        "converges"
    ),
    r"turn(s|ed|ing)? over\b": "dissipated (power); overturns (a body)",
    r"left over\b|leftovers?\b": "residual, rest",
    r"what (it|they|is|the \w+|a \w+) (left|leaves?)\b(?! out)": "residual, rest",
    r"near(by)? (start|solve)s?\b|starts? nearby\b": "warm start",
    r"good units?\b|(is|are) good (for|to)\b|good to \d": "scaled units; accuracy",
    r"(?<!frequently )asked\b|(is|are|was|were) held to\b": "requested, required",
    r"bars? of (the )?(certificate|residual|tolerance|\d)": "tolerance",
    r"(above|below|within|meets?|met by|at|over) (the|its|this|ten) bars?\b": "tolerance",
    r"the bar (is|was) [\d.]": "tolerance",
    r"(a|another|one|first|second|closer|quick) looks?\b(?! like)": "check",
    r"(a|each|every|one|another) round (of|that|is|begins|ends|takes)\b": "iteration",
    r"(two|three|few|more|\d+) (more )?rounds\b": "iterations",
    r"besides?\b": "next to, in addition to",
    r"(in|inside) each other\b": "overlaps",
    r"larger than life\b": "displacements exaggerated",
    r"(go|goes|going|went|gone) by\b|vary by levels?\b|varies by levels?\b": "varies with",
    r"(?<!axis )of revolution\b|in \(r, z\)": "axisymmetric",
    r"in space\b(?! and)": "three-dimensional, in three dimensions",
    r"(problem|bod(y|ie)|case|block|load|structure|soil|mesh|element)s? of the plane\b": "plane",
    r"(?:that|what) deforms?\b(?! plastically)": "deformable",
    r"strength zero\b": "cohesionless, tensionless",
    r"of one's own\b|(field|function) of your own\b": "user-defined",
    r"plant(s|ed|ing)? (an?|the|one) \w*\s?errors?\b|planted\b": "inject an error",
    r"newcomers?'?\b|wrong runs?\b": "new user; invalid input",
    r"(?<!typed )(?<!written )(?<!edited )by hand\b": "analytical, analytically",
    r"questions? (of|to) (an |the |all |a )?(engineer|user|case)s?\b|more questions\b": "analysis",
    r"(each|every|page a) question\b": "analysis",
    r"(?<!no )(?<!more )(?<!enough )rooms?\b(?! for\b| temperature)": "package",
    r"houses?\b": "project, package",
    r"front doors?\b|doors? (of|to|into) (the )?(package|lacore|room|module|user)s?\b": "interface",
    r"floors? of (the )?(house|package|code)s?\b": "layer",
    r"everything against everything\b": "every combination",
    r"set (themselves|itself|themself) up\b": "create .venv on first use",
    rf"(a|an|one) ({ITEM}) an? (?!name\b)[a-z]+\b": "one ... per ...",
    r"(?<!there )(is|are) no (number|bound|answer|proof|mesh|case)\b": "is not a ...",
}
"""Patterns of private words, matched without regard to case, and what to write instead."""
_PATTERNS = {re.compile(rf"\b(?:{how})", re.IGNORECASE): write for how, write in PRIVATE.items()}
_FENCE = re.compile(r"^```[^\n]*\n(.*?)^```", re.DOTALL | re.MULTILINE)
_COMMENT = re.compile(r"#+ .*")
_NAMES = re.compile(r"^ +\*{0,2}\w+(, \*{0,2}\w+)*:", re.MULTILINE)


def prose(page):
    """Return the sentences of a Markdown page: its text, and the comments in its code."""
    comments = [text for code in _FENCE.findall(page) for text in _COMMENT.findall(code)]
    text = re.sub(r"<!--.*?-->", "", _FENCE.sub("", page), flags=re.DOTALL)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return re.sub(r"`[^`]*`", "`code`", text) + "\n\n" + "\n".join(comments)


def private_words(text):
    """Return the private words of a text, each with its surroundings and the term to write."""
    line = " ".join(text.split())
    for pattern, write in _PATTERNS.items():
        for found in pattern.finditer(line):
            around = line[max(0, found.start() - 40) : found.end() + 40]
            yield f"{found[0]!r} in {around!r}: write {write}"


def texts(source):
    """Yield texts of four words or more: docstrings, without names of arguments, and messages."""
    for node in ast.walk(ast.parse(source)):
        value = node.value if isinstance(node, ast.Constant) else None
        if isinstance(value, str) and value.count(" ") >= 3:
            yield _NAMES.sub("", value)


def comments(source):
    """Yield comments, those of consecutive lines as one text."""
    text, last = "", -1
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            if token.start[0] != last + 1:
                yield text
                text = ""
            text, last = f"{text} {token.string.lstrip('# ')}", token.start[0]
    yield text


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_pages_use_established_terms(page):
    assert [*private_words(prose(page.read_text(encoding="utf-8")))] == []


@pytest.mark.parametrize("package", PACKAGES, ids=lambda place: str(place.relative_to(ROOT)))
def test_docstrings_messages_and_comments_use_established_terms(package):
    found = []
    for file in sorted(package.rglob("*.py")):
        source = file.read_text(encoding="utf-8")
        for text in (*texts(source), *comments(source)):
            found += [f"{file.relative_to(ROOT)}: {word}" for word in private_words(prose(text))]
    assert found == []


@pytest.mark.parametrize("name", [None, *cli.main.commands])
def test_help_texts_use_established_terms(name):
    command = cli.main if name is None else cli.main.commands[name]
    with click.Context(command, info_name=name) as context:
        assert [*private_words(prose(f"{command.get_help(context)}\n{cli.START}"))] == []


@pytest.mark.parametrize("name", starters.titles())
def test_starter_files_use_established_terms(name):
    assert [*private_words(starters.text(name))] == []


@pytest.mark.parametrize(
    "text",
    [
        "It names the field, the value and the mend.",
        "What a Coulomb\nload factor is worth",
        "a page with pictures beside it",
        "```sh\nlacore compare  # a first look at every case\n```",
        "| bodies of revolution | none |",
        "The loop goes on until it settles.",
        "The rooms of the house have an order.",
    ],
)
def test_private_words_are_found(text):
    assert [*private_words(prose(text))]


@pytest.mark.parametrize(
    "text",
    [
        "A bar in tension has one cone, and there is no room for error.",
        "The rule is said to be associated.",
        "The axis of revolution is vertical, and time and space are discretised.",
        "The value is worth knowing; the load falls by 2 %.",
        "```python\nmend = told[0]\n```",
        "The attribute `mend` names <!-- told --> the [fix](said.md).",
    ],
)
def test_ordinary_words_are_not_found(text):
    assert [*private_words(prose(text))] == []
