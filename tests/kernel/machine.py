# SPDX-License-Identifier: MIT
"""The machines of the rig: which QEMU, whose kernel, where programs find their libraries.

A machine boots a kernel and an initramfs, has its console on one serial port and the results on
another (port), and knows how a program of its architecture is packed.
"""
import lzma
import os
import re
import shutil
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
DTB = "broadcom/bcm2837-rpi-3-b.dtb"
FETCH = os.path.join(HERE, "../../board/fetch-debs")


class CannotRun(Exception):
    pass


class Outdated(CannotRun):
    """What is known of the mirror is not so, or no more: it has one version of a package."""


def give_up(why):
    raise CannotRun(why)


def output(*command, cwd=None):
    try:
        return subprocess.run(command, check=True, cwd=cwd, stdout=subprocess.PIPE, text=True).stdout
    except (OSError, subprocess.CalledProcessError) as err:
        give_up(f"{' '.join(command)}: {err}")


def fetch(*command, cwd=None):
    try:
        output(*command, cwd=cwd)
    except CannotRun as err:
        raise Outdated(str(err)) from err


class Machine:
    name = qemu = console = port = ""
    arguments = serial = network = ()
    append = ""
    install = "board/install-deps kernel"
    modules = """vhci-hcd i2c-tiny-usb i2c-dev wire ds2482 w1_therm w1_smem w1_ds2405 w1_ds2406
    w1_ds2408 w1_ds2413 w1_ds2423 w1_ds2430 w1_ds2431 w1_ds2433 w1_ds2438
    w1_ds2780 w1_ds2781 w1_ds28e04 w1_ds28e17 ds2760_battery ds2490 overlay
    virtio_pci virtio_net usbserial cdc_acm""".split()

    def kernel_package(self, cache):
        """Name and version of the package that Debian's meta package stands for."""
        raise NotImplementedError

    def look_again(self, cache):
        """After Outdated: see to it that the version of now is named."""
        raise NotImplementedError

    def fetch_kernel(self, package, version, folder):
        """Download it into folder; Outdated when it cannot be had."""
        raise NotImplementedError

    def unpack_kernel(self, vmlinuz, target):
        """What QEMU is to start, out of the package's file."""
        raise NotImplementedError

    def kernel_arguments(self, kernel):
        """What QEMU is told besides -kernel."""
        return ()

    def busybox(self, folder):
        """A static busybox of this architecture, and its applets as far as we can ask it."""
        raise NotImplementedError

    def libraries(self, program, folders):
        """(file, name in the guest) of all libraries that the program needs."""
        raise NotImplementedError


class Amd64(Machine):
    name = "amd64"
    qemu = "qemu-system-x86_64"
    console, port = "ttyS0", "ttyS1"
    arguments = ("-cpu", "max", "-smp", "1", "-m", "1024", "-M", "q35")
    serial = ("-serial", "stdio")
    network = ("-nic", "user,model=virtio-net-pci")
    # A busy host lets too few ticks through while the kernel tries its timer, which then panics
    append = "mitigations=off tsc=reliable no_timer_check"

    def kernel_package(self, cache):
        if output("dpkg", "--print-architecture").strip() != "amd64":
            give_up("needs an amd64 system")
        depends = re.search(r"Depends: (linux-image-\S+)", output("apt-cache", "depends",
                                                                   "linux-image-amd64"))
        if not depends:
            raise Outdated("apt knows no linux-image-amd64: run apt-get update")
        show = output("apt-cache", "show", "--no-all-versions", depends[1])
        return depends[1], re.search(r"^Version: (\S+)", show, re.M)[1]

    def look_again(self, cache):
        """In the lists of now; who may not read them anew keeps the old ones."""
        subprocess.run(["apt-get", "-qq", "-o", "Acquire::Retries=5", "update"], check=False,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def fetch_kernel(self, package, version, folder):
        fetch("apt-get", "-q", "-o", "Acquire::Retries=5", "download", f"{package}={version}",
              cwd=folder)

    def unpack_kernel(self, vmlinuz, target):
        """The ELF inside has a PVH entry: QEMU starts it without the slow unpacking in the guest."""
        made = f"{target}.{os.getpid()}"  # another may be starting what is there
        with open(vmlinuz, "rb") as file:
            image = file.read()
        start = image.find(b"\xfd7zXZ\x00")
        data = lzma.LZMADecompressor().decompress(image[start:]) if start >= 0 else image
        with open(made, "wb") as file:
            file.write(data)
        os.rename(made, target)

    def busybox(self, folder):
        path = "/bin/busybox"
        if not os.path.exists(path):
            give_up(f"needs busybox-static: {self.install}")
        return path, [name for name in output(path, "--list").split() if name != "busybox"]

    def libraries(self, program, folders):
        ldd = subprocess.run(["ldd", program], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                             text=True, check=False).stdout
        return [(path, path) for path in re.findall(r"(/\S+) \(0x", ldd)]


class Arm64(Machine):
    """-M virt: a PL061 is its GPIO chip, whose line 3 is the power key."""
    name = "arm64"
    qemu = "qemu-system-aarch64"
    console, port = "ttyAMA0", "ttyS0"
    # the second UART of virt is the secure world's: results go over PCI
    arguments = ("-cpu", "cortex-a57", "-smp", "1", "-m", "512", "-M", "virt")
    serial = ("-chardev", "stdio,id=results,signal=off", "-device", "pci-serial,chardev=results")
    install = "board/install-deps arm64"
    modules = Machine.modules + ["gpio-sim"]
    meta = "linux-image-arm64"
    suite = "-"  # of this machine
    # libc6-arm64-cross
    sysroot = "/usr/aarch64-linux-gnu/lib"

    def metas(self, cache):
        """The folder for the meta package, and what is in it."""
        folder = os.path.join(cache, "arm64" if self.suite == "-" else f"arm64-{self.suite}")
        os.makedirs(folder, exist_ok=True)
        return folder, sorted(os.path.join(folder, name) for name in os.listdir(folder)
                              if name.startswith(self.meta + "_"))

    def kernel_package(self, cache):
        folder, metas = self.metas(cache)
        if not metas:
            output(FETCH, self.suite, "arm64", folder, self.meta)
            metas = self.metas(cache)[1]
        depends = output("dpkg-deb", "-f", metas[-1], "Depends")
        found = re.search(r"(linux-image-\S+) \(= (\S+)\)", depends)
        return found[1], found[2]

    def look_again(self, cache):
        for meta in self.metas(cache)[1]:
            os.unlink(meta)

    def fetch_kernel(self, package, version, folder):
        fetch(FETCH, self.suite, "arm64", folder, package)

    def unpack_kernel(self, vmlinuz, target):
        shutil.copyfile(vmlinuz, target)
        boot, name = os.path.split(vmlinuz)
        shutil.copyfile(os.path.join(boot, "../usr/lib", name.replace("vmlinuz", "linux-image"), DTB),
                        target + ".dtb")

    def busybox(self, folder):
        root = os.path.join(folder, "busybox")
        path = os.path.join(root, "bin/busybox")
        if not os.path.exists(path):
            output(FETCH, "-x", "-", "arm64", root, "busybox-static")
        return path, ["sh"]  # init has it make the others

    def needed(self, program):
        return re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "-d", program))

    def libraries(self, program, folders):
        found, names = {}, self.needed(program)
        if names:
            names.append("ld-linux-aarch64.so.1")
        for name in names:
            if name in found:
                continue
            paths = [os.path.join(folder, name) for folder in (*folders, self.sysroot)]
            path = next((path for path in paths if os.path.exists(path)), None)
            if not path:
                give_up(f"{program} needs {name}, which is not in {' '.join(folders)}")
            found[name] = os.path.realpath(path)
            names += self.needed(path)
        return [(path, "/lib/" + name) for name, path in found.items()]


class Raspi(Arm64):
    """A Raspberry Pi 3 with Debian's kernel. It does not end by itself."""
    name = "raspi3b"
    port = "ttyS1"
    arguments = ("-smp", "4", "-m", "1024", "-M", "raspi3b")
    serial = ("-serial", "stdio")

    def kernel_arguments(self, kernel):
        return ("-dtb", kernel + ".dtb")


MACHINES = {machine.name: machine for machine in (Amd64(), Arm64(), Raspi())}
