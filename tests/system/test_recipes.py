#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What other distributions are given: recipes of Alpine, Buildroot and Yocto, the list of Raspberry Pi
Imager, the compose file. They are made of one version and of the tables, their own distributions' judges
have nothing against them, and they build what they say.

Judges that are a repository are clones in the user's cache folder, or are fetched into it; their commit,
which is the checksum of their files, is fixed here.
"""

import hashlib
import json
import lzma
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.request

import clients
import owsdtest
from owsdtest import SOURCE

BOARD = SOURCE / "board"
VERSION = re.search(r"^VERSION *:= *(\S+)", (SOURCE / "Makefile").read_text(), re.M)[1]
FACES = [re.split(r" *\| *", line) for line in (BOARD / "faces").read_text().splitlines() if line[0] != "#"]
BUILDROOT_S60 = "buildroot/package/owsd/S60owsd"
BUILDROOT = "e991fa071605a78c17adba2ed26e07c3b8c95583"
IMAGER = "72ad1179ff46a8355291898416fe65cbe6bbd450"
ALPINE = "https://dl-cdn.alpinelinux.org/alpine/v3.20/releases/x86_64/alpine-minirootfs-3.20.3-x86_64.tar.gz"
ALPINE_SUM = "d4e6fd67dcf75e40c451560ac7265166c2b72a0f38ddc9aae756a7de3d1efa0c"


def run(*command, cwd, wrong=False, limit=900, **env):
    done = subprocess.run([str(c) for c in command], cwd=cwd, text=True, timeout=limit, check=False,
                          env=dict(without_make(), **env), stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert (done.returncode != 0) == wrong, f"{command}: {done.returncode}: {done.stdout[-2000:]}"
    return done.stdout


def without_make():
    return {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "CC", "CXX", "OWS_DIR")}


def cache():
    return pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"


def repository(owner_name, commit):
    """The git directory of a clone that has the commit."""
    place = cache() / owner_name.split("/")[1]

    def git(*words):
        return subprocess.run(["git", "-C", str(place), *words], capture_output=True, text=True, timeout=300,
                              check=False).returncode
    if not place.is_dir() or git("cat-file", "-e", commit):
        place.mkdir(parents=True, exist_ok=True)
        git("init", "-q")
        if git("fetch", "-q", "--depth", "1", f"https://github.com/{owner_name}", commit):
            owsdtest.skip(f"{owner_name} cannot be had: a clone of it may be at {place}")
    return place


def unpack(place, commit, to, *paths):
    to.mkdir(parents=True, exist_ok=True)
    files = subprocess.run(["git", "-C", place, "archive", commit, *paths], stdout=subprocess.PIPE, check=True).stdout
    subprocess.run(["tar", "-x", "-C", to], input=files, check=True)


def source_tree(to):
    """What a release has of this tree."""
    to.mkdir(parents=True)
    for name in ("src", "hal", "tests", "board", "docs"):
        shutil.copytree(SOURCE / name, to / name, ignore=shutil.ignore_patterns("__pycache__", "build"))
    for file in (SOURCE / "Makefile", SOURCE / "LICENSE", *SOURCE.glob("*.md")):
        shutil.copy(file, to)
    return to


def recipes(scene, board=BOARD, content=b"a tarball"):
    tarball = scene.path / f"owsd-{VERSION}.tar.xz"
    tarball.write_bytes(content)
    out = scene.path / "recipes"
    run(sys.executable, board / "make-recipes", "--url", "https://owsd.example.org/dist", "--out", out, tarball,
        cwd=scene.path)
    return out


def test_the_recipes_are_of_one_version_and_have_each_face(scene):
    out = recipes(scene)
    files = {file.name: file.read_text() for file in out.rglob("*") if file.is_file()}
    assert set(files) == {"APKBUILD", "owsd.pre-install", "owsd.pre-upgrade", "Config.in", "owsd.mk", "owsd.hash", "S60owsd",
                          f"owsd_{VERSION}.bb"}, files.keys()
    assert f"\npkgver={VERSION}\n" in files["APKBUILD"] and f"\nOWSD_VERSION = {VERSION}\n" in files["owsd.mk"]
    for name, kind in (("APKBUILD", "sha512"), ("owsd.hash", "sha256"), (f"owsd_{VERSION}.bb", "sha256")):
        assert hashlib.new(kind, b"a tarball").hexdigest() in files[name], name
    for program, _, package, user, groups, _ in FACES:
        option = f"BR2_PACKAGE_{program.upper().replace('-', '_')}"
        for name, text in (("APKBUILD", f"\t{package}:_face\n"), ("APKBUILD", f"usr/sbin/{program}"),
                           ("owsd.pre-install", f'user {program} "{user}" {groups}\n'), ("Config.in", f"config {option}\n"),
                           ("owsd.mk", f"$(if $({option}),{program})"), ("owsd.mk", f"- {groups.replace(' ', ',')} {user}\n"),
                           (f"owsd_{VERSION}.bb", f"${{sbindir}}/{program} "), (f"owsd_{VERSION}.bb", f'RDEPENDS:{package} = ')):
            assert text in files[name], f"{name} has no {text}"
    assert files["owsd.pre-upgrade"] == files["owsd.pre-install"]
    for script in re.search(r'^install="(.*)"$', files["APKBUILD"], re.M)[1].replace("$pkgname", "owsd").split():
        assert script in files, script
    for name, text in files.items():
        assert not re.search(r"@[A-Za-z]\w*@", text), f"{name} has a name of the template"


def test_a_face_that_is_new_is_in_all_recipes(scene):
    shutil.copytree(BOARD, scene.path / "tree/board")
    for name in ("Makefile", "LICENSE"):
        shutil.copy(SOURCE / name, scene.path / "tree")
    with open(scene.path / "tree/board/faces", "a", encoding="ascii") as file:
        file.write("owsd-lines | CURL | owsd-lines | 1-Wire in lines | owsd | -\n")
    out = recipes(scene, scene.path / "tree/board")
    for name in ("alpine/APKBUILD", "alpine/owsd.pre-install", "buildroot/package/owsd/Config.in",
                 "buildroot/package/owsd/owsd.mk", f"yocto/owsd_{VERSION}.bb"):
        assert "owsd-lines" in (out / name).read_text(), name
    assert "$(BR2_PACKAGE_OWSD_NOTIFY)$(BR2_PACKAGE_OWSD_LINES)" in (out / "buildroot/package/owsd/owsd.mk").read_text()


def test_the_files_of_a_program_have_the_mode_of_its_unit_on_alpine_too(scene):
    for program in ("owsd", *(row[0] for row in FACES if row[0] != "owsd-writer")):
        unit = re.search(r"^UMask=0(.*)$", (BOARD / f"systemd/{program}@.service").read_text(), re.M)[1]
        given = run("sh", "-c", f". {BOARD}/alpine/owsd.initd && echo $umask", cwd=scene.path, RC_SVCNAME=f"{program}.HOUSE")
        assert given == f"{unit}\n", (program, given)


def test_a_tarball_of_another_version_is_refused(scene):
    (scene.path / "owsd-0.0.1.tar.xz").write_bytes(b"")
    said = run(sys.executable, BOARD / "make-recipes", "owsd-0.0.1.tar.xz", cwd=scene.path, wrong=True)
    assert f"owsd-{VERSION}.tar.xz" in said and not (scene.path / "build").exists(), said


def test_buildroot_finds_nothing_in_its_recipe(scene):
    tree = scene.path / "buildroot"
    unpack(repository("buildroot/buildroot", BUILDROOT), BUILDROOT, tree, "utils", "package/owfs")
    place = clients.environment("buildroot-judge", ["python-magic==0.4.27", "flake8==7.5.0"])
    shutil.copytree(recipes(scene) / "buildroot/package/owsd", tree / "package/owsd")
    files = sorted(f"package/owsd/{file.name}" for file in (tree / "package/owsd").iterdir())
    judge = [place / "python", "utils/check-package"]
    path = f"{place}:{os.environ['PATH']}"
    said = run(*judge, *files, cwd=tree, PATH=path)
    assert "\n0 warnings generated" in said, said
    (tree / "package/owsd/owsd.mk").write_text((tree / "package/owsd/owsd.mk").read_text().replace("\nOWSD_SITE", "\nSITE_OF"))
    assert "SITE_OF" in run(*judge, *files, cwd=tree, PATH=path, wrong=True)


# What Buildroot has around a recipe, with this machine's compiler
AROUND = """
MAKEFLAGS += --no-print-directory
INSTALL = install
OWSD_PKGDIR = {recipe}
TARGET_CONFIGURE_OPTS = CC="gcc" CXX="g++" AR="ar" OBJCOPY="objcopy" CFLAGS="-O1"
HOSTCC = gcc
TARGET_DIR = {top}/target
STAGING_DIR = {top}/staging
include {recipe}/owsd.mk
SOURCE_DIR = {top}/source
build:
	$(OWSD_BUILD_CMDS)
install:
	$(OWSD_INSTALL_STAGING_CMDS)
	$(OWSD_INSTALL_TARGET_CMDS)
	$(OWSD_INSTALL_INIT_SYSV)
"""


def test_the_script_of_buildroot_follows_no_link_that_a_program_has_left(scene):
    """What root does in a folder of a program, it does as that program; beside it are stand-ins."""
    top, tools = scene.path / "top", scene.path / "bin"
    script = re.sub(r"(?<![\w.])/(run|var/lib|var/run|usr/sbin|etc/default)/", rf"{top}/\1/",
                    (BOARD / BUILDROOT_S60).read_text())
    script = scene.file("S60owsd", script.replace('OWSD_FACES=""', 'OWSD_FACES="recorder"'))
    for folder in (tools, *(top / name for name in ("run", "var/lib", "var/run", "usr/sbin"))):
        folder.mkdir(parents=True)
    stand_ins = {"install": f'mkdir -p "$(eval echo \\"\\$$#\\")"; echo "install $*" >>{top}/asked',
                 "su": f'echo "su $3" >>{top}/asked; shift 3; exec sh "$@"',
                 "start-stop-daemon": "exit 1", "logger": "cat >/dev/null"}
    for name, text in stand_ins.items():
        (tools / name).write_text(f"#!/bin/sh\n{text}\n")
    for name in ("owsd", "owsd-recorder"):
        (top / "usr/sbin" / name).write_text("#!/bin/sh\n")
    for file in (*tools.iterdir(), *(top / "usr/sbin").iterdir()):
        file.chmod(0o755)
    run("sh", script, "start", cwd=scene.path, PATH=f"{tools}:{os.environ['PATH']}")
    asked = (top / "asked").read_text().replace(str(top), "").splitlines()
    assert "su owsd-recorder" in asked and (top / "var/lib/owsd-recorder/OWS").is_dir(), asked
    assert (top / "run/owsd-recorder/OWS").is_dir() and not (top / "run/owsd/OWS").exists(), asked
    given = {word for line in asked if line.startswith("install") for word in line.split() if word.startswith("/")}
    assert given == {"/run/owsd", "/var/lib/owsd", "/run/owsd-recorder", "/var/lib/owsd-recorder"}, given
    assert "install -d -m 755 -o owsd -g owsd /run/owsd" in asked, asked


def test_the_recipe_of_buildroot_builds_the_faces_that_are_chosen(scene):
    recipe = recipes(scene) / "buildroot/package/owsd"
    source_tree(scene.path / "source")
    (recipe / "owsd.mk").write_text((recipe / "owsd.mk").read_text().replace("$(@D)", "$(SOURCE_DIR)"))
    makefile = scene.file("around.mk", AROUND.format(recipe=recipe, top=scene.path))
    chosen = {"MODBUS": "owsd-modbus"}
    if "libsqlite3 yes" in (owsdtest.BUILD / "with/libraries").read_text():
        chosen["RECORDER"] = "owsd-recorder"
    options = [f"BR2_PACKAGE_OWSD_{name}=y" for name in chosen]
    jobs = f"-j{os.cpu_count()}"
    run("make", "-s", jobs, "-f", makefile, *options, "build", cwd=scene.path)
    run("make", "-s", jobs, "-f", makefile, *options, "install", cwd=scene.path)
    target = scene.path / "target"
    assert {f.name for f in (target / "usr/sbin").iterdir()} == {"owsd", *chosen.values()}
    assert {f.name for f in (target / "usr/bin").iterdir()} == {"owsctl"}
    assert (target / "etc/owsd/OWS.rio").exists() and os.access(target / "etc/init.d/S60owsd", os.X_OK)
    assert not (target / "usr/share/owsd/web").exists()
    assert (scene.path / "staging/usr/include/ows.h").exists()
    assert VERSION in run(target / "usr/sbin/owsd", "-V", cwd=scene.path)


# What abuild has around an APKBUILD
ABUILD = """
set -eu
export srcdir={top} pkgdir={top}/pkg startdir={recipe}
amove() {{
	for f; do
		mkdir -p "$subpkgdir/${{f%/*}}"
		mv "$pkgdir/$f" "$subpkgdir/${{f%/*}}"
	done
}}
. {recipe}/APKBUILD
builddir={top}/source
cd "$builddir"
build
check
package
for sub in $subpackages; do
	subpkgname=${{sub%%:*}} name=${{sub#*:}}
	case $sub in *:*) name=${{name%%:*}} ;; *-sim) name=sim ;; *) continue ;; esac
	subpkgdir={top}/$subpkgname
	case $subpkgname in {without}) continue ;; esac
	(cd "$pkgdir" && subpkgname=$subpkgname subpkgdir=$subpkgdir && $name)
done
"""


BUILT = []


def build_for_musl(scene):
    """The packages of Alpine, as folders, but for faces whose libraries musl-gcc has not; built once for
    all cases."""
    if BUILT:
        return BUILT[0]
    if not shutil.which("musl-gcc"):
        owsdtest.skip("musl-gcc is not installed")
    recipe, top = recipes(scene) / "alpine", owsdtest.folder()
    source_tree(top / "source")
    left_out = {row[2] for row in FACES if row[1] != "-" and row[0] != "owsd-web"} | {"libows-history"}
    around = ABUILD.format(top=top, recipe=recipe, without="|".join(sorted(left_out)))
    # Of the package owsd-web there is the writer alone
    around = around.replace("\nbuild\n", '\nexport CC=musl-gcc MAKEFLAGS=-sj%d\nbuild\n' % os.cpu_count())
    script = scene.file("around.sh", around)
    file = recipe / "APKBUILD"
    file.write_text(file.read_text().replace(" usr/sbin/owsd-web ", " "))
    run("sh", script, cwd=scene.path)
    BUILT.append(top)
    return top


def test_alpines_recipe_builds_with_musl_and_each_file_has_its_package(scene):
    top = build_for_musl(scene)
    assert {f.name for f in (top / "pkg/usr/sbin").iterdir()} == {"owsd"}
    assert {f.name for f in (top / "pkg/usr/bin").iterdir()} == {"owsctl"}
    assert {f.name for f in (top / "pkg/etc/init.d").iterdir()} == {"owsd", *(row[0] for row in FACES)} - {"owsd-writer"}
    for package, file in (("owsd-modbus", "usr/sbin/owsd-modbus"), ("owsd-web", "usr/sbin/owsd-writer"),
                          ("owsd-web", "usr/share/owsd/web/index.html"), ("owsd-sim", "usr/bin/owsctl-sim"),
                          ("libows", f"usr/lib/libows.so.{VERSION}")):
        assert (top / package / file).is_file(), f"{package} has no {file}"
    needed = run("readelf", "-d", top / "pkg/usr/sbin/owsd", cwd=top)
    assert "[libc.so]" in needed and "libc.so.6" not in needed, needed
    assert len(list((top / "py3-ows").rglob("*-packages/ows.py"))) == 1


def minirootfs(scene):
    """A folder with Alpine's smallest system, out of the user's cache or, once, from Alpine."""
    if os.geteuid() or os.uname().machine != "x86_64":
        owsdtest.skip("needs root, for chroot, on amd64")
    file = cache() / ALPINE.split("/")[-1]
    if not file.exists():
        try:
            with urllib.request.urlopen(ALPINE, timeout=20) as answer:
                file.write_bytes(answer.read())
        except OSError as error:
            owsdtest.skip(f"Alpine cannot be had ({error}): its minirootfs may be at {file}")
    assert hashlib.sha256(file.read_bytes()).hexdigest() == ALPINE_SUM, f"{file} is another one"
    root = scene.path / "alpine"
    root.mkdir()
    run("tar", "-xzf", file, "-C", root, cwd=scene.path)
    return root


IN_ALPINE = """
mount -t proc proc /proc && mount -t tmpfs tmpfs /dev && mknod -m 666 /dev/null c 1 3
sh /pre-install && id -nG owsd
sh -n /etc/init.d/owsd
owsd --check >/dev/null
mkdir -m 755 /run/owsd && chown owsd:owsd /run/owsd
printf '%s\n' 'chip DS2482-100 0x18' 'DS18B20 28.000000000001 temperature 21.5' >/tmp/wire.sim
printf '%s\n' 'OwsDrv {' 'TargetName "sim:/tmp/wire.sim"' 'ItemCount 1' 'Item {' 'Name "room"' \
	'Path "/28.000000000001/temperature"' 'Type "double"' '}' '}' >/etc/owsd/OWS.rio
su -s /bin/sh -c 'exec owsd-sim' owsd &
for n in $(seq 150); do
	! owsctl get room 2>/dev/null || exit 0
	sleep 0.2
done
exit 1
"""


def test_the_packages_of_alpine_run_on_it(scene):
    root = minirootfs(scene)
    top = build_for_musl(scene)
    for package in ("pkg", "owsd-sim", "owsd-modbus", "libows"):
        run("cp", "-a", f"{top / package}/.", root, cwd=top)
    shutil.copy(recipes(scene) / "alpine/owsd.pre-install", root / "pre-install")
    said = run("unshare", "-m", "-p", "-f", "--kill-child", "chroot", root, "/bin/sh", "-ec", IN_ALPINE, cwd=scene.path,
               PATH="/usr/sbin:/usr/bin:/sbin:/bin")
    assert "owsd-control" in said and said.rstrip().endswith("21.5"), said


def test_oelint_finds_nothing_in_the_recipe_of_yocto(scene):
    place = clients.environment("oelint", ["oelint-adv==9.11.2"])
    file = recipes(scene) / f"yocto/owsd_{VERSION}.bb"
    # A daemon is no tool of the build, and its page is not asked for
    judge = [place / "oelint-adv", "--quiet", "--exit-zero", "--suppress", "oelint.var.bbclassextend",
             "--suppress", "oelint.vars.homepageping"]
    said = run(*judge, file, cwd=scene.path)
    found = [line for line in said.splitlines() if re.search(r":(error|warning|info):", line)]
    assert not found, "\n".join(found)
    file.write_text(file.read_text().replace('LICENSE = "MIT"\n', "").replace("SRC_URI[sha256sum]", "SRC_URI[sha0]"))
    said = run(*judge, file, cwd=scene.path)
    assert "oelint.var.mandatoryvar.LICENSE" in said, said


def judge_of_schemas():
    place = clients.environment("jsonschema", ["check-jsonschema==0.39.0"])
    return place / "check-jsonschema"


def test_the_compose_file_is_of_its_schema_and_owsd_takes_its_configuration(scene):
    judge, file = [judge_of_schemas(), "--builtin-schema", "vendor.compose-spec"], BOARD / "oci/compose.yaml"
    run(*judge, file, cwd=scene.path)
    wrong = scene.file("compose.yaml", file.read_text().replace("read_only:", "readonly:"))
    assert "readonly" in run(*judge, wrong, cwd=scene.path, wrong=True)
    named = re.search(r"OWSD_FACES: (.*)", file.read_text())[1].split()
    assert {f"owsd-{name}" for name in named} <= {row[0] for row in FACES}
    done = scene.owsd_once("--check", "-c", BOARD / "oci/owsd/OWS.rio")
    assert done.returncode == 0 and not owsdtest.but_of_here(done.stderr), done.stderr
    for name in ("mosquitto", "victoriametrics"):
        assert f"  {name}:\n" in file.read_text() and f"//{name}" in (BOARD / "oci/owsd/OWS.rio").read_text()


def test_imager_takes_the_list_and_its_sums_are_of_the_image(scene):
    content = bytes(range(256)) * 4096
    image = scene.path / "2026-12-31-owsd-arm64.img.xz"
    image.write_bytes(lzma.compress(content))
    command = [sys.executable, BOARD / "make-imager", "--url", "https://owsd.example.org/images/"]
    made = json.loads(run(*command, image, cwd=scene.path))
    entry, = made["os_list"]
    assert (entry["extract_size"], entry["extract_sha256"]) == (len(content), hashlib.sha256(content).hexdigest())
    assert entry["image_download_size"] == image.stat().st_size and entry["release_date"] == "2026-12-31"
    assert entry["url"] == f"https://owsd.example.org/images/{image.name}"
    (scene.path / "owsd.img.xz").write_bytes(image.read_bytes())
    assert "arm64" in run(*command, "owsd.img.xz", cwd=scene.path, wrong=True)

    schema_of = scene.path / "imager"
    unpack(repository("raspberrypi/rpi-imager", IMAGER), IMAGER, schema_of, "doc/json-schema")
    judge = [judge_of_schemas(), "--schemafile", schema_of / "doc/json-schema/os-list-schema.json"]
    run(*judge, scene.file("os_list.json", json.dumps(made)), cwd=scene.path)
    del entry["extract_sha256"]
    run(*judge, scene.file("os_list.json", json.dumps(made)), cwd=scene.path, wrong=True)


if __name__ == "__main__":
    owsdtest.main()
