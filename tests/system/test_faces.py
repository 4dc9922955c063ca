#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""board/faces is the table of the faces: what is made of it is whole, and what is written by hand
names each of them."""

import re
import subprocess

import owsdtest
from owsdtest import SOURCE

TABLE = [re.split(r" *\| *", line) for line in (SOURCE / "board/faces").read_text().splitlines()
         if not line.startswith("#")]


def units(program):
    return {end: SOURCE / "board/systemd" / f"{program}@.{end}" for end in ("service", "socket")}


def test_each_face_is_where_a_person_looks_for_it(_scene):
    for program, _, package, *_ in TABLE:
        has = [("docs/README.md", f"[{program}(8)]({program}.8)"), (f"docs/{program}.8", program),
               ("board/debian/control", f"Package: {package}\n")]
        for file, text in has:
            assert text in (SOURCE / file).read_text(), f"{file} lacks {text}"


def test_the_units_of_an_instance_are_those_of_the_table(_scene):
    for program, *_, signals in TABLE:
        unit = units(program)["service"].read_text()
        assert f"ExecStart=@SBINDIR@/{program} -n %i\n" in unit, program
        assert f"\nUser={program}\n" in unit and f"man:{program}(8)" in unit, program
        assert (f"PartOf={program}.service" in unit) == (signals != "-"), program
        assert units(program)["socket"].exists() == (signals == "-"), program
    named = {file.name.split("@")[0] for file in (SOURCE / "board/systemd").glob("owsd-*@*")}
    assert named == {row[0] for row in TABLE}, named


def test_the_table_makes_users_units_and_what_the_packages_hold(scene):
    made = scene.path / "made"
    for more in ([], [], ["--debian"]):
        subprocess.run(["sh", SOURCE / "board/face-files", *more, made / "".join(more)], check=True,
                       timeout=owsdtest.PATIENCE)
    for program, _, package, user, groups, signals in TABLE:
        lines = (made / f"{program}.sysusers").read_text().splitlines()
        assert f'u {program} - "{user}" /nonexistent' in lines, lines
        assert all({f"g {group} -", f"m {program} {group}"} <= set(lines) for group in groups.split())
        assert lines.count(f"g {program} -") == 1, lines
        unit = made / f"{program}.service"
        assert unit.exists() == (signals != "-")
        assert signals == "-" or f"Description={signals}\n" in unit.read_text()
        of = made / "--debian"
        assert f"usr/sbin/{program}\n" in (of / f"{package}.install").read_text()
        assert f"usr/share/man/man8/{program}.8\n" in (of / f"{package}.manpages").read_text()
        assert f"\nu {program} " in (of / f"{package}.sysusers").read_text()
        assert (of / f"{package}.postrm").exists() == (signals != "-")
        assert signals == "-" or f"rm -rf /var/lib/{program}\n" in (of / f"{package}.postrm").read_text()


def test_each_way_to_make_owsds_user_puts_it_into_the_groups_that_its_files_are_for(_scene):
    groups = set(re.findall(r'mode_for\("([\w-]+)"', (SOURCE / "src/daemon/serve/listener.c").read_text()))
    assert groups == {"owsd-control", "owsd-config"}, groups
    for file, form in (("systemd/sysusers.conf", r"^m owsd +{}$"), ("alpine/owsd.pre-install", r'^user owsd ".*\b{}\b'),
                       ("buildroot/package/owsd/owsd.mk", r"owsd -1 .*\b{}\b"), ("yocto/owsd.bb", r" -G \S*\b{}\b")):
        for group in groups:
            assert re.search(form.format(group), (SOURCE / "board" / file).read_text(), re.M), (file, group)


if __name__ == "__main__":
    owsdtest.main()
