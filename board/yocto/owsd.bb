# SPDX-License-Identifier: MIT
SUMMARY = "1-Wire devices as named signals in shared memory"
DESCRIPTION = "A 1-Wire network as a table of signals that a control program reads and sets as variables."
HOMEPAGE = "@URL@"
BUGTRACKER = "@URL@"
SECTION = "utils"
LICENSE = "MIT"
LIC_FILES_CHKSUM = "file://LICENSE;md5=@LICENSE_MD5@"

SRC_URI = "@URL@/${BP}.tar.xz"
SRC_URI[sha256sum] = "@SHA256@"

CVE_PRODUCT = "owsd"

inherit features_check pkgconfig systemd useradd

# The units are below /usr/lib
REQUIRED_DISTRO_FEATURES = "systemd usrmerge"

# A face is built where its library is
PACKAGECONFIG ??= "@libraries@"
@each-library@
PACKAGECONFIG[@name@] = "@makefile@,@off@,@yocto@"
@end@

EXTRA_OEMAKE = "\
    CC='${CC}' \
    AR='${AR}' \
    OBJCOPY='${OBJCOPY}' \
    HOSTCC='${BUILD_CC}' \
    PREFIX=${prefix} \
    LIBDIR=${libdir} \
    DYGRAPHS= \
    LIBPROTOBUFC=0 \
    ${PACKAGECONFIG_CONFARGS} \
"

do_compile() {
    oe_runmake all
}

do_install() {
    oe_runmake DESTDIR=${D} install install-service
    rm -r ${D}${datadir}/cockpit
}

USERADD_PACKAGES = "${PN} @packages@"
GROUPADD_PARAM:${PN} = "-r owsd; -r owsd-control; -r owsd-config; -r i2c; -r gpio; -f -r dialout"
USERADD_PARAM:${PN} = "-r -M -s /sbin/nologin -g owsd -G owsd-control,owsd-config,i2c,gpio,dialout owsd"
@each-package@
GROUPADD_PARAM:@package@ = "@groupadd@"
USERADD_PARAM:@package@ = "@useradd@"
@end@

SYSTEMD_SERVICE:${PN} = "owsd.service owsd@OWS.service"

PACKAGE_BEFORE_PN = "libows libows-history ${PN}-sim @packages@"
CONFFILES:${PN} = "${sysconfdir}/owsd/OWS.rio"
FILES:${PN} += "${nonarch_libdir} ${datadir}/bash-completion ${datadir}/zsh"
FILES:${PN}-sim += "${sbindir}/owsd-sim ${sbindir}/owsd-writer-sim ${bindir}/owsctl-sim"
FILES:libows += "${libdir}/libows${SOLIBS}"
FILES:libows-history += "${libdir}/libows-history${SOLIBS}"
@each-package@
FILES:@package@ += "@files@"
@end@
@each-package@
RDEPENDS:@package@ = "${PN}"
@end@
