################################################################################
#
# owsd
#
################################################################################

# SPDX-License-Identifier: MIT
OWSD_VERSION = @VERSION@
OWSD_SOURCE = owsd-$(OWSD_VERSION).tar.xz
OWSD_SITE = @URL@
OWSD_LICENSE = MIT
OWSD_LICENSE_FILES = LICENSE
OWSD_INSTALL_STAGING = YES
OWSD_DEPENDENCIES = host-pkgconf
OWSD_MAKE_OPTS = \
	$(TARGET_CONFIGURE_OPTS) \
	HOSTCC="$(HOSTCC)" \
	PREFIX=/usr \
	DYGRAPHS= \
	LIBPROTOBUFC=0 \
	FACES="$(OWSD_FACES)"
@each@
OWSD_FACES += $(if $(BR2_PACKAGE_@option@),@program@)
@end@
@each-library@

ifneq (@chosen@,)
OWSD_DEPENDENCIES += @depends@
OWSD_MAKE_OPTS += @makefile@
else
OWSD_MAKE_OPTS += @off@
endif
@end@

define OWSD_BUILD_CMDS
	$(TARGET_MAKE_ENV) $(MAKE) -C $(@D) $(OWSD_MAKE_OPTS) all
endef

define OWSD_INSTALL_STAGING_CMDS
	$(TARGET_MAKE_ENV) $(MAKE) -C $(@D) $(OWSD_MAKE_OPTS) \
		DESTDIR=$(STAGING_DIR) install
endef

# Without the simulator
define OWSD_INSTALL_TARGET_CMDS
	$(TARGET_MAKE_ENV) $(MAKE) -C $(@D) $(OWSD_MAKE_OPTS) \
		DESTDIR=$(TARGET_DIR) install
	rm -f $(TARGET_DIR)/usr/sbin/owsd*-sim $(TARGET_DIR)/usr/bin/owsctl-sim
	rm -rf $(TARGET_DIR)/usr/share/cockpit/owsd \
		$(TARGET_DIR)/usr/share/owsd/examples
	$(if $(BR2_PACKAGE_OWSD_WEB),,rm -rf $(TARGET_DIR)/usr/share/owsd/web)
	$(INSTALL) -D -m 0644 $(@D)/board/debian/OWS.rio \
		$(TARGET_DIR)/etc/owsd/OWS.rio
	$(INSTALL) -D -m 0644 $(@D)/board/udev/owsd.rules \
		$(TARGET_DIR)/usr/lib/udev/rules.d/60-owsd.rules
endef

define OWSD_INSTALL_INIT_SYSV
	$(INSTALL) -D -m 0755 $(OWSD_PKGDIR)/S60owsd \
		$(TARGET_DIR)/etc/init.d/S60owsd
endef

define OWSD_INSTALL_INIT_SYSTEMD
	$(TARGET_MAKE_ENV) $(MAKE) -C $(@D) $(OWSD_MAKE_OPTS) \
		DESTDIR=$(TARGET_DIR) install-service
endef

define OWSD_USERS
	owsd -1 owsd -1 * - - owsd-control,owsd-config,i2c,gpio,dialout 1-Wire daemon
@each@
	@program@ -1 @program@ -1 * - - @list@ @user@
@end@
endef

$(eval $(generic-package))
