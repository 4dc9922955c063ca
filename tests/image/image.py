# SPDX-License-Identifier: MIT
"""A Raspberry Pi's kind of image that boots in QEMU: Debian 13 for arm64, to which pi-gen's stage of
board/image is applied as pi-gen does it. The bare root is kept in the cache, the image in a folder
of the caller's.
"""
import glob
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(TOP, "tests/kernel"))
from machine import CannotRun, give_up, output  # noqa: E402

SUITE, ARCH = "trixie", "arm64"
CACHE = os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"),
                     "owsd", "image")
STAGE = os.path.join(TOP, "board/image/pi-gen/stage-owsd/00-owsd")
# What an image has anyway, and what our packages depend on
PACKAGES = """systemd systemd-sysv udev kmod dbus init-system-helpers iproute2 python3 libgpiod3
libi2c0""".split()
LEAVE_OUT = ("locale", "doc", "man", "info", "zoneinfo")
MODULES = """virtio_net vhci-hcd i2c-tiny-usb i2c-dev wire ds2482 w1_therm w1_ds2408 w1_ds2423 autofs4
binfmt_misc ipv6 unix dm-mod configfs efi_pstore fuse loop""".split()
SIZE = "768M"
MONTH = 30 * 86400
BINFMT = "/proc/sys/fs/binfmt_misc"
# What pi-gen exports to a stage, here without its script's other doings
ON_CHROOT = """set -eu
on_chroot() { chroot "$ROOTFS_DIR" env DEBIAN_FRONTEND=noninteractive LC_ALL=C bash -e; }
export -f on_chroot
mount -t proc proc "$ROOTFS_DIR/proc"
mount -t tmpfs tmpfs "$ROOTFS_DIR/tmp"
cd "$1" && ./00-run.sh
"""


def digest_of(*parts):
    """Of texts and of files, folders with all they have."""
    digest = hashlib.sha256()
    for part in parts:
        if not os.path.exists(part):
            digest.update(part.encode())
            continue
        names = [part] if os.path.isfile(part) else sorted(
            name for name in glob.glob(part + "/**", recursive=True) if os.path.isfile(name))
        for name in names:
            digest.update(name.encode())
            with open(name, "rb") as file:
                digest.update(file.read())
    return digest.hexdigest()[:12]


def ready():
    """The tools are there, and programs for arm64 run here."""
    if os.geteuid():
        give_up("an image's files belong to root: run it as root")
    for tool in ("mmdebstrap", "mke2fs", "qemu-img", "qemu-aarch64-static", "unshare"):
        if not shutil.which(tool, path=os.environ["PATH"] + ":/usr/sbin:/sbin"):
            give_up(f"{tool} is missing: board/install-deps image")
    if not output("sh", os.path.join(TOP, "board/apt-mirrors")).strip():
        give_up("this machine's apt sources name no mirror")
    if os.path.exists(os.path.join(BINFMT, "qemu-aarch64")):
        return
    # What systemd-binfmt does at the start of a machine that has systemd
    try:
        if not os.path.exists(os.path.join(BINFMT, "register")):
            subprocess.run(["mount", "-t", "binfmt_misc", "binfmt_misc", BINFMT], check=True)
        with open("/usr/lib/binfmt.d/qemu-aarch64.conf", encoding="ascii") as file:
            line = next(line for line in file if line.startswith(":")).strip()
        with open(os.path.join(BINFMT, "register"), "w", encoding="ascii") as file:
            file.write(line)
    except (OSError, StopIteration, subprocess.CalledProcessError) as err:
        give_up(f"this kernel runs no program for arm64, and takes none: {err}")


def base():
    """A tar of Debian as an image has it before the stage."""
    with open(os.path.join(STAGE, "00-packages"), encoding="ascii") as file:
        packages = PACKAGES + file.read().split()
    path = os.path.join(CACHE, f"{SUITE}-{digest_of(SUITE, ARCH, *packages, *LEAVE_OUT)}.tar")
    os.makedirs(CACHE, exist_ok=True)
    for old in glob.glob(os.path.join(CACHE, "*.tar")):
        if time.time() - os.path.getmtime(old) > MONTH:
            os.unlink(old)
    if os.path.exists(path):
        return path
    print(f"# image: making a root of {SUITE} for {ARCH}", flush=True)
    made = f"{path}.{os.getpid()}"
    mirrors = output("sh", os.path.join(TOP, "board/apt-mirrors")).splitlines()
    for attempt in range(3 * len(mirrors)):
        if attempt and attempt % len(mirrors) == 0:
            time.sleep(15)  # a network may be away for a moment
        uri, key = mirrors[attempt % len(mirrors)].split()
        option = "" if key == "-" else f"[signed-by={key}] "
        command = ["mmdebstrap", "--quiet", "--variant=apt", "--arch=" + ARCH, "--format=tar",
                   "--include=" + ",".join(packages), "--aptopt=APT::Install-Recommends \"false\"",
                   "--aptopt=Acquire::Retries \"5\"",
                   *(f"--dpkgopt=path-exclude=/usr/share/{name}/*" for name in LEAVE_OUT),
                   SUITE, made, f"deb {option}{uri} {SUITE} main"]
        if subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                          check=False).returncode == 0:
            os.rename(made, path)
            return path
    if os.path.exists(made):
        os.unlink(made)
    give_up("mmdebstrap made no root: see above")


def add_kernel(rig, machine, root):
    """Modules as the kernel's package would bring them, those that are needed."""
    package, version = machine.kernel_package(rig.CACHE)
    deb = glob.glob(os.path.join(rig.CACHE, f"{package}_{version}", "linux-image*.deb"))[0]
    with tempfile.TemporaryDirectory(dir=CACHE) as unpacked:
        output("dpkg-deb", "-x", deb, unpacked)
        os.symlink("usr/lib", os.path.join(unpacked, "lib"))
        release = os.listdir(os.path.join(unpacked, "lib/modules"))[0]
        subprocess.run(["depmod", "-b", unpacked, release], check=True)
        top = "usr/lib/modules/" + release
        for name in rig.wanted_modules(unpacked, release, MODULES):
            target = os.path.join(root, top, name)
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copy(os.path.join(unpacked, top, name), target)
        for name in ("modules.builtin", "modules.builtin.modinfo", "modules.order"):
            shutil.copy(os.path.join(unpacked, top, name), os.path.join(root, top))
    subprocess.run(["depmod", "-b", root, release], check=True)


def apply_stage(root, debs):
    firmware = os.path.join(root, "boot/firmware")
    os.makedirs(firmware, exist_ok=True)
    with open(os.path.join(firmware, "config.txt"), "w", encoding="ascii") as file:
        file.write("dtparam=audio=on\n")
    env = dict(os.environ, ROOTFS_DIR=root, ARCH=ARCH, RELEASE=SUITE, OWSD_DEBS=debs)
    done = subprocess.run(["unshare", "-m", "bash", "-c", ON_CHROOT, "stage", STAGE], env=env,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        print(done.stdout[-4000:])
        raise RuntimeError("pi-gen's stage failed")
    # as pi-gen's export does: the first boot is one for systemd, too
    with open(os.path.join(root, "etc/machine-id"), "w", encoding="ascii") as file:
        file.write("uninitialized\n")


def packages(debs):
    """Our packages, built when what runs of them has changed since."""
    board = [name for name in glob.glob(os.path.join(TOP, "board/*"))
             if os.path.basename(name) not in ("image", "demo")]
    now = digest_of(*(os.path.join(TOP, name) for name in
                      ("Makefile", "src", "hal", "docs/examples")),
                    *sorted(board))
    stamp = os.path.join(debs, f".{SUITE}-{ARCH}")
    if os.path.exists(stamp):
        with open(stamp, encoding="ascii") as file:
            if file.read() == now:
                return
    for old in (*glob.glob(os.path.join(debs, f"*+deb13_{ARCH}.*")),
                *glob.glob(os.path.join(debs, "*+deb13_all.deb"))):
        os.unlink(old)
    print(f"# image: building the packages for {ARCH} and {SUITE}", flush=True)
    # Make's own settings and this machine's compiler are not those of the clean system
    env = {name: text for name, text in os.environ.items()
           if name not in ("CC", "CXX", "AR", "MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    done = subprocess.run(["sh", os.path.join(TOP, "board/make-deb"), "--suite", SUITE,
                           "--out", debs, ARCH], env=env, check=False,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        print(done.stdout[-4000:])
        raise RuntimeError("the packages cannot be built")
    with open(stamp, "w", encoding="ascii") as file:
        file.write(now)


def reader(compiler, debs, folder):
    """The C example, built against our packages for the guest."""
    with tempfile.TemporaryDirectory(dir=folder) as root:
        for name in ("libows-dev", "libows1"):
            deb = glob.glob(os.path.join(debs, f"{name}_*+deb13_{ARCH}.deb"))[0]
            output("dpkg-deb", "-x", deb, root)
        # The guest's libc is newer than this machine's: it has what the library wants of it
        output(*compiler.split(), "-O2", "-o", os.path.join(folder, "reader"),
               os.path.join(root, "usr/share/doc/libows-dev/examples/reader.c"),
               "-I" + os.path.join(root, "usr/include"),
               "-L" + os.path.join(root, "usr/lib/aarch64-linux-gnu"), "-lows",
               "-Wl,--allow-shlib-undefined")
    return os.path.join(folder, "reader")


def image(rig, machine, debs, folder):
    """Path of the disk's image; made when anything that goes into it has changed."""
    ours = output("sh", os.path.join(TOP, "board/image/debs"), debs, ARCH, SUITE).split()
    tar = base()
    key = digest_of(tar, *ours, os.path.join(TOP, "board/image"),
                    os.path.join(TOP, "board/boards"), __file__,
                    *machine.kernel_package(rig.CACHE))
    path = os.path.join(folder, f"{key}.img")
    if os.path.exists(path):
        return path
    os.makedirs(folder, exist_ok=True)
    for old in glob.glob(os.path.join(folder, "*.img*")):
        os.unlink(old)
    began = time.monotonic()
    with tempfile.TemporaryDirectory(dir=CACHE) as root:
        os.chmod(root, 0o755)
        output("tar", "-x", "--numeric-owner", "--xattrs", "-f", tar, "-C", root)
        add_kernel(rig, machine, root)
        apply_stage(root, debs)
        output("mke2fs", "-q", "-t", "ext4", "-m", "0", "-L", "root", "-d", root, path + ".new", SIZE)
        os.rename(path + ".new", path)
    print(f"# image: made in {time.monotonic() - began:.0f} s", flush=True)
    return path
