# SPDX-License-Identifier: MIT
"""The prose of the pages: words, and in 1000 of them the semicolons and the words that stand for a noun.

tests/lint/budgets.tsv has of each page how many there may be. `make format` lowers a budget to what
the page has, with some room, and never raises one: a page may only become shorter and clearer. Who has
to add much to a page raises its words there by hand. Blocks, tables and manual pages are not counted.
"""

import re

BUDGETS = "tests/lint/budgets.tsv"
HEAD = "page\twords\tsemicolons\tstand-ins\n"
# The budget of a page without a row
OTHERS = (2500, 15, 100)
STAND_INS = set("it its itself that those these this which what who whom whose whoever whatever one ones "
                "they them their such else he she his her".split())
GUIDES = set("alarms bring-up consumers export fleet from-owfs from-rexygen history history-queries image linuxcnc "
             "notify openplc web".split())


def prose(text):
    text = re.sub(r"^ *```.*?^ *```$", "", text, flags=re.M | re.S)
    text = re.sub(r"^ *\|.*$|^#.*$|<!--.*?-->", "", text, flags=re.M)
    return re.sub(r"`[^`]*`|\]\([^)]*\)", " X ", text)


def counted(text):
    """(words, semicolons in 1000 of them, stand-ins in 1000 of them)"""
    text = prose(text)
    words = re.findall(r"[A-Za-z][\w'-]*", text)
    thousand = max(len(words), 1) / 1000
    return (len(words), -(-text.count(";") // thousand),
            -(-sum(word.lower() in STAND_INS for word in words) // thousand))


def pages(tree):
    made = ("NEWS.md", "docs/devices.md", "docs/properties.md")
    return [f for f in tree.files if re.fullmatch(r"docs/[\w-]+\.md|[A-Z]+\.md", f) and f not in made]


def budgets(tree):
    rows = [line.split("\t") for line in tree.text(BUDGETS).splitlines()[1:]]
    return {page: tuple(map(int, most)) for page, *most in rows}


def check_no_page_grows_or_becomes_harder_to_read(tree):
    if BUDGETS not in tree.files:
        return
    given = budgets(tree)
    for page in pages(tree):
        for name, has, most, advice in zip(
                ("words", "semicolons in 1000 words", "stand-ins in 1000 words (it, that, which, who, what, ...)"),
                counted(tree.text(page)), given.get(page, OTHERS),
                (f"shorten it, move facts to their page, or raise its words in {BUDGETS}",
                 "end the sentence", "name the thing")):
            if has > most:
                yield page, 1, f"{has:.0f} {name}, and {most} are its budget: {advice}"


def check_each_guide_ends_with_what_comes_next(tree):
    for page in pages(tree):
        if page.removeprefix("docs/").removesuffix(".md") in GUIDES:
            last = tree.text(page).rsplit("\n## ", 1)[-1]
            if not last.startswith("Next\n") or last.count("](") < 2:
                yield page, 1, 'end it with "## Next" and two or three links'


def check_each_item_of_a_list_begins_a_line(tree):
    for page in pages(tree):
        text = re.sub(r"^ *```.*?^ *```$", lambda block: "\n" * block[0].count("\n"), tree.text(page), flags=re.M | re.S)
        for number, line in enumerate(text.split("\n"), 1):
            if re.search(r"[.:;)] - |\S - \*\*|\w -$", line) and not line.startswith("|"):
                yield page, number, "begin a line with each item of a list"


def check_no_guide_names_the_source(tree):
    """Who reads a guide has packages. history.md says where the schema stands."""
    for page in pages(tree):
        if page.removeprefix("docs/").removesuffix(".md") in GUIDES - {"history"}:
            for number, line in enumerate(tree.text(page).split("\n"), 1):
                if re.search(r"`(?:tests|src|hal)/|`make (?:test|unit|bench)", line):
                    yield page, number, "say it in tested.md, or in a page for those who change owsd"


def mend(tree):
    if BUDGETS not in tree.files:
        return
    given = budgets(tree)
    rows = []
    for page in pages(tree):
        words, semicolons, stand_ins = map(int, counted(tree.text(page)))
        has = (words + max(150, words // 10), semicolons + 2, stand_ins + 3)
        rows.append("\t".join([page, *(str(min(pair)) for pair in zip(has, given.get(page, has)))]) + "\n")
    (tree.top / BUDGETS).write_text(HEAD + "".join(rows))
