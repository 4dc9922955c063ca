# SPDX-License-Identifier: MIT
"""The documentation as data: the blocks, commands, paths and links of a page.

A block of a Markdown page names its language behind the three backticks; one without a language is
an error of the page, as nobody knows what to do with it. In man pages it is what EXAMPLES has.
"""

import collections
import re

# file: the name by which the page calls it, as in "`first.c`:" before it, or None
Block = collections.namedtuple("Block", "page line language text file")
MAN_LANGUAGE = {".1": "sh", ".3": "c", ".5": "rio", ".sim.5": "sim", ".7": "sh", ".8": "sh"}
FENCE = re.compile(r"^( *)```(.*)$")


def blocks(path):
    """All blocks of a page, indented ones with the language None."""
    if path.suffix != ".md":
        return man_blocks(path)
    return list(markdown_blocks(path.name, path.read_text().split("\n")))


def markdown_blocks(page, lines):
    at, blank, deep, file = 0, True, " " * 4, None  # deep: where an indented block begins
    while at < len(lines):
        line, begun = lines[at], at + 1
        fence = FENCE.match(line)
        if fence:
            at += 1
            while not lines[at].strip().startswith("```"):
                at += 1
            indent = len(fence[1])
            yield Block(page, begun, fence[2].strip() or None,
                        "".join(row[indent:] + "\n" for row in lines[begun:at]), file)
        elif line.startswith(deep) and line.strip() and blank:
            while at < len(lines) and (lines[at].startswith(deep) or not lines[at].strip()):
                at += 1
            yield Block(page, begun, None, "\n".join(lines[begun - 1:at]), None)
            at -= 1
        if line.strip():
            named = re.search(r"`([\w./-]+\.\w+)`[^`]*:$", line)
            file = named and named[1]
            item = re.match(r"(\s*(?:[-*]|\d+\.) +)", line)
            if item or not line.startswith(" "):
                deep = " " * (4 + len(item[1]) if item else 4)
        blank = not line.strip()
        at += 1


def man_blocks(path):
    text = path.read_text()
    heading = re.search(r"^\.S[Hh] EXAMPLES$", text, re.M)
    section = re.split(r"^\.S[Hh] ", text[heading.end():], maxsplit=1, flags=re.M)[0]
    line = text[:heading.end()].count("\n") + 1
    found = re.findall(r"^\.(?:nf|EX|Bd .*)\n(.*?)^\.(?:fi|EE|Ed)$", section, re.M | re.S)
    return [Block(path.name, line, MAN_LANGUAGE.get("".join(path.suffixes[-2:]), MAN_LANGUAGE[path.suffix]), plain(t), None) for t in found]


def plain(text):
    """Roff without its escapes."""
    return text.replace("\\-", "-").replace("\\e", "\\").replace("\\&", "")


def console(text):
    """The commands of a console block, each with what the page shows of it."""
    commands = re.split(r"^\$ ", text, flags=re.M)
    assert not commands[0].strip(), "a console block begins with a command: $ ..."
    return [(command, expected) for command, _, expected in (c.partition("\n") for c in commands[1:])]


def like(expected, said):
    """Numbers, times, users and ... stand for anything; nothing expected: the page does not show it."""
    expected, said = (re.sub(r"\d{4}-\d\d-\d\dT[\d:.+-]+", "TIME", re.sub(r"\(user \w+\)", "(user)", text))
                      for text in (expected, said.replace(" (sim)", "")))
    pattern = re.escape(re.sub(r"-?\d+(\.\d+)?[smhd]?\b", "\0", expected.strip()))
    pattern = pattern.replace("\0", r"-?[\d.]+[smhd]?").replace(re.escape("..."), "(?s:.*)")
    pattern = re.sub(r"(\\ |\\\n|\n)+", r"\\s+", pattern)
    return not expected.strip() or re.fullmatch(pattern, said.strip())


def prose(path):
    """The page without its blocks: (line number, text)."""
    inside = False
    for number, line in enumerate(path.read_text().split("\n"), 1):
        if FENCE.match(line):
            inside = not inside
        elif not inside:
            yield number, line


def items(path):
    """What is explained in a list below it, or in the cells beside it: (line number, text)."""
    begun, first = None, ""
    for number, line in prose(path):
        if line.startswith("  - "):
            if begun:
                yield begun, first
            begun = None
        elif line.startswith("- "):
            begun, first = number, line
        elif line.startswith("| "):
            yield number, line.split("|")[1]
        elif begun and line.startswith("  "):
            first += line[1:]
        else:
            begun = None


def inline(path):
    """What stands in backticks in the prose."""
    for number, line in prose(path):
        for code in re.findall(r"`([^`]+)`", line):
            yield number, code


def links(path):
    for number, line in prose(path):
        for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
            yield number, target


def anchors(path):
    """The anchors of a page's headings, as the hosting sites make them."""
    found = set()
    for _, line in prose(path):
        heading = re.match(r"#+ (.*)$", line)
        if heading:
            title = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
            found.add(re.sub(r"[^\w\- ]", "", title).strip().replace(" ", "-"))
    return found
