# SPDX-License-Identifier: MIT
"""Files as text and as syntax: layout, widths, heads, names, what each language demands."""

import ast
import collections
import json
import re
import shutil
import subprocess
import xml.etree.ElementTree

from tree import Skip, parallel

FORMAT_VERSION = "14"  # another one breaks lines elsewhere
WIDTH = 100
SCRIPT_WIDTH = 120  # nothing breaks its lines but a person
# Files that have no place for a licence, or one of others
UNSIGNED = (".json", ".md", ".rio", ".svg", ".png", ".tsv", ".sim", ".webmanifest", ".txt", ".xml")
SIGNED = (".c", ".h", ".cpp", ".py", ".mk", ".js", ".css", ".html", ".sh", ".service", ".socket")
TOKEN = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|/\*.*?\*/|//[^\n]*', re.S)


# --- The layout of C --------------------------------------------------------------------------------

def clang_format():
    if not shutil.which("clang-format"):
        raise Skip("clang-format is not installed (sh board/install-deps lint)")
    about = subprocess.run(["clang-format", "--version"], capture_output=True, text=True,
                           check=False).stdout.strip()
    if f"version {FORMAT_VERSION}." not in about:
        raise Skip(f"{about} is not version {FORMAT_VERSION}")


def check_c_is_laid_out_as_clang_format_says(tree):
    clang_format()
    for output in parallel(["clang-format", "--dry-run"], tree.c()):
        for file, line in re.findall(r"^(\S+?):(\d+):\d+: \w+: code should be clang-formatted",
                                     output, re.M):
            yield file, int(line), "not laid out as .clang-format says; run make format"


def mend(tree):
    for file in blank_files(tree):
        mended = re.sub(r"[ \t]+$", "", tree.text(file), flags=re.M).rstrip("\n") + "\n"
        if mended != tree.text(file):
            (tree.top / file).write_text(mended)
    clang_format()
    parallel(["clang-format", "-i"], tree.c())


# --- Lines ------------------------------------------------------------------------------------------

def check_no_comment_in_c_is_wider_than_100_columns(tree):
    """Code is clang-format's to break, and what it cannot break is no shorter for that."""
    for file in tree.c():
        lines = tree.text(file).expandtabs(8).split("\n")
        if max(map(len, lines)) <= WIDTH:
            continue
        for found in TOKEN.finditer(tree.text(file)):
            if found[0].startswith("/"):
                first, last = (tree.text(file).count("\n", 0, at) for at in found.span())
                for n in range(first, last + 1):
                    if len(lines[n]) > WIDTH:
                        yield file, n + 1, f"{len(lines[n])} columns; wrap the comment at {WIDTH}"


def check_no_line_of_a_script_is_wider_than_120_columns(tree):
    for file in tree.ending(".js"):
        for n, line in enumerate(tree.text(file).expandtabs(8).split("\n"), 1):
            if len(line) > SCRIPT_WIDTH:
                yield file, n, f"{len(line)} columns; wrap the line at {SCRIPT_WIDTH}"


# Files above 500 lines that are one concept
LONG = {"src/public/ows.h": "the interface of libows", "src/public/ows_layout.h": "the layout of the memory",
        "src/faces/mqtt/sparkplug.c": "a profile", "src/faces/mqtt/stream.c": "the rows of a node",
        "src/daemon/serve/client.c": "to be split",
        "hal/owserver/owserver.c": "to be split", "hal/sim/slave.c": "a simulated chip"}


def check_no_file_of_c_is_longer_than_500_lines(tree):
    for file in tree.ending(".c", ".h"):
        lines = tree.text(file).count("\n") if file.startswith(("src/", "hal/")) else 0
        if lines > 500 and file not in LONG:
            yield file, 500, f"{lines} lines; split the file"
        if lines <= 500 and file in LONG:
            yield file, 1, "no longer above 500 lines; take it out of tests/lint/form.py"


def blank_files(tree):
    """Code of ours. What a page shows of a program may have blanks at its end."""
    return [f for f in [*tree.ending(".c", ".h", ".cpp", ".py", ".mk", ".sh"),
                        *tree.scripts("sh", "bash", "python"), *tree.ending("Makefile")]]


def check_no_line_ends_with_a_blank_and_each_file_with_a_line(tree):
    for file in blank_files(tree):
        text = tree.text(file)
        for n, line in enumerate(text.split("\n"), 1):
            if line != line.rstrip(" \t"):
                yield file, n, "a blank at the end of the line; run make format"
        if text and (not text.endswith("\n") or text.endswith("\n\n")):
            yield file, text.count("\n"), "the file has to end with one line end; run make format"


# --- Pages ------------------------------------------------------------------------------------------

def check_each_row_of_a_page_belongs_to_a_table_and_no_item_is_empty(tree):
    """A row alone renders as a paragraph of bars; empty items were a table once."""
    for file in tree.ending(".md"):
        lines, code = ["", *tree.text(file).split("\n"), ""], False
        for n, line in enumerate(lines[:-1]):
            code ^= line.lstrip().startswith("```")
            if code:
                continue
            if line.startswith("|") and lines[n - 1][:1] != "|" and not re.fullmatch(r"\|[-:| ]+", lines[n + 1]):
                yield file, n, "a row without a table; put the head or the rows before it there"
            if re.fullmatch(r" *[-*] *", line):
                yield file, n, "an empty item; make a table of the list"


# --- Secrets ----------------------------------------------------------------------------------------

def check_no_credential_is_read_where_another_user_than_root_makes_files(tree):
    """/etc/owsd may belong to owsd-writer, and root follows a link that it makes there."""
    for file in tree.files:
        for n, line in enumerate(tree.text(file).split("\n"), 1):
            if re.search(r"LoadCredential(Encrypted)?=[^:\s]+:\S*/owsd/", line):
                yield file, n, "a credential in a directory of owsd's users; name one in /etc/credstore"


# --- Heads ------------------------------------------------------------------------------------------

def check_each_file_of_code_has_one_spdx_line(tree):
    scripts = set(tree.scripts("sh", "bash", "python"))
    for file in tree.files:
        if file.endswith(UNSIGNED) or "/data/" in file:
            continue
        if not (file.endswith(SIGNED) or file in scripts or file in ("Makefile", "tests/suites")):
            continue
        head = [n for n, line in enumerate(tree.text(file).split("\n")[:8], 1)
                if "SPDX-License-Identifier: " in line]
        if len(head) != 1:
            yield file, 1, f"{len(head) or 'no'} SPDX lines; begin it with SPDX-License-Identifier: MIT, once"


# --- Names ------------------------------------------------------------------------------------------

def check_each_header_has_a_guard_of_its_own(tree):
    """Another's guard hides the header where both are included."""
    guards = collections.defaultdict(list)
    for file in tree.c():
        if file.endswith(".h"):
            found = re.search(r"^#ifndef (\w+)\n#define (\w+)$", tree.text(file), re.M)
            if not found:
                continue  # a list, which is included more than once
            if found[1] != found[2]:
                yield file, tree.line_of(file, found[0]), f"#ifndef {found[1]}, but #define {found[2]}"
            guards[found[1]].append(file)
    for guard, files in guards.items():
        for file in files[1:]:
            yield file, tree.line_of(file, guard), \
                f"{guard} is the guard of {files[0]} too; name it by the path of the file"


def check_each_unit_test_has_a_program_of_its_own_and_is_named_test(tree):
    """Programs are named as the files, wherever they stand."""
    seen = {}
    for file in tree.c():
        folders, name = file.split("/")[:-1], file.split("/")[-1]
        if folders[:2] == ["tests", "unit"] and name.endswith(".c") and "aid" not in folders:
            if not re.fullmatch(r"test_[a-z0-9_]+\.c", name):
                yield file, 1, "make unit would not find it; name it test_SOMETHING.c"
            if name in seen:
                yield file, 1, f"makes the same program as {seen[name]}; give it another name"
            seen[name] = file


def check_each_unit_test_is_run(tree):
    for file in tree.c():
        if re.match(r"tests/unit/.*/test_\w+\.c", file):
            words = collections.Counter(re.findall(r"\w+", tree.text(file)))
            for name in re.findall(r"^static void (test_\w+)\(void\)\n\{", tree.text(file), re.M):
                if words[name] < 2:
                    yield file, tree.line_of(file, name), f"{name} is not run; add RUN_TEST({name})"


# --- Sleeps -----------------------------------------------------------------------------------------

SLEEP = {"c": re.compile(r"\b(?:u|nano)?sleep\([^)]"), "python": re.compile(r"\btime\.sleep\([^)]"),
         "sh": re.compile(r"(?:^|[;&|({]|\b(?:do|then|else))\s*u?sleep [0-9]")}


def check_each_sleep_of_a_test_says_what_it_stands_for(tree):
    """On its line: a comment, the shortest of which is `pace`, for one of a loop that looks. A
    bench measures what is after a while."""
    for files, kind in ((tree.ending(".c"), "c"),
                        ({*tree.ending(".py"), *tree.scripts("python")}, "python"),
                        ({*tree.ending(".sh"), *tree.scripts("sh", "bash")}, "sh")):
        for file in files:
            if not file.startswith("tests/") or file.startswith(("tests/bench/", "tests/kernel/guest/bench")):
                continue
            for n, line in enumerate(tree.text(file).split("\n"), 1):
                found = SLEEP[kind].search(line)
                if found and not re.search(r"/\*|//|#", line[found.start():]):
                    yield file, n, "a bare sleep; wait for the thing itself, or say behind it what it stands for"


# --- Syntax -----------------------------------------------------------------------------------------

def check_python_is_python_and_no_test_hides_another(tree):
    for file in sorted({*tree.ending(".py"), *tree.scripts("python")}):
        try:
            parsed = ast.parse(tree.text(file), file)
        except SyntaxError as error:
            yield file, error.lineno or 1, f"{error.msg}; python3 cannot read it"
            continue
        seen = set()
        for node in parsed.body:
            if isinstance(node, ast.FunctionDef):
                if node.name in seen:
                    yield file, node.lineno, f"{node.name} stands here twice; give it another name"
                seen.add(node.name)


def check_json_and_svg_can_be_read(tree):
    for file in tree.ending(".json", ".webmanifest"):
        try:
            json.loads(tree.bytes(file))
        except ValueError as error:
            yield file, getattr(error, "lineno", 1), f"{error}; make it JSON"
    for file in tree.ending(".svg"):
        try:
            xml.etree.ElementTree.fromstring(tree.bytes(file))
        except xml.etree.ElementTree.ParseError as error:
            yield file, error.position[0], f"{error}; make it XML"


def shells(tree):
    parts = [f for f in tree.ending(".sh") if not tree.text(f).startswith("#!")]
    return [("bash", tree.scripts("bash")), ("sh", sorted({*tree.scripts("sh"), *parts}))]


def check_shell_scripts_can_be_read(tree):
    for shell, files in shells(tree):
        for file in files:
            done = subprocess.run([shell, "-n", file], capture_output=True, text=True, check=False)
            if done.returncode:
                line = re.search(r": (?:line )?(\d+): ", done.stderr)
                yield file, int(line[1]) if line else 1, f"{done.stderr.strip()}; {shell} cannot read it"


# Where all that shellcheck says is followed; of the others, what it calls an error
STRICT = ("board/image/",)


def check_shellcheck_finds_nothing(tree):
    if not shutil.which("shellcheck"):
        raise Skip("shellcheck is not installed (sh board/install-deps lint)")
    for shell, files in shells(tree):
        strict = [f for f in files if f.startswith(STRICT)]
        for options, some in ([], strict), (["-S", "error"], [f for f in files if f not in strict]):
            for output in parallel(["shellcheck", "-f", "gcc", "-s", shell, *options], some):
                for file, line, text in re.findall(r"^(.+?):(\d+):\d+: (.*)$", output, re.M):
                    yield file, int(line), text


def check_the_page_of_a_library_names_all_that_its_header_has(tree):
    """Functions, and the names of enumerations."""
    headers = {f.rpartition("/")[2]: f for f in tree.files if re.fullmatch(r"src/\w+/\w+/\w+\.h", f)}
    for page in (f for f in tree.files if re.fullmatch(r"docs/[^/]+\.3", f)):
        text = tree.text(page)
        for header in (n for n in re.findall(r"#include <(\w+\.h)>", text) if n in headers):
            bare = TOKEN.sub("", tree.text(headers[header]))
            names = re.findall(r"\b(\w+)\(", bare) + [
                name for body in re.findall(r"enum \w+ \{(.*?)\}", bare, re.S)
                for name in re.findall(r"(\w+)\s*(?:=[^,]*)?(?:,|$)", body.strip())]
            for name in names:
                if not re.search(rf"\b{name}\b", text):
                    yield page, 1, f"{header} has {name}: say what it is"


def check_manual_pages_are_well_formed(tree):
    if not shutil.which("mandoc"):
        raise Skip("mandoc is not installed (sh board/install-deps lint)")
    manuals = [f for f in tree.files if re.fullmatch(r"docs/[^/]+\.[1-8]", f)]
    for output in parallel(["mandoc", "-T", "lint", "-W", "warning"], manuals):
        for file, line, text in re.findall(r"^mandoc: (.+?):(\d+):\d+: (.*)$", output, re.M):
            if "missing date" not in text:  # what they describe has a version
                yield file, int(line), text
