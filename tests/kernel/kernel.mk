# SPDX-License-Identifier: MIT
# The kernel rig: Debian's own kernel in QEMU, a simulated chip behind a real I2C adapter.
# SUITES picks from tests/kernel/guest; KERNEL_TIME bounds each guest, in seconds; OR_SKIP=1 counts
# suites as skipped that cannot run for want of QEMU, the kernel's package or the peers.

KERNEL_TIME ?= 1200
RIG_FRONT   := $(B)/tests/kernel/vhci.o $(B)/tests/kernel/usbip.o $(B)/tests/kernel/tiny_usb.o \
               $(B)/tests/kernel/control.o
RIG_OURS    := $(B)/kernel/simchip $(B)/kernel/owdump $(B)/kernel/busdump $(B)/kernel/owwalk $(PROGRAMS)
ENDURANCE   := $(B)/kernel/endurance
RIG_PEERS    = $(foreach p,owserver i2cdetect i2cget i2cset i2ctransfer curl mosquitto mosquitto_pub mosquitto_sub mbpoll,\
                 $(shell PATH="$$PATH:/usr/sbin" command -v $(p))) $(B)/kernel/apparmor_parser
RIG_GUEST   := $(filter-out %/init,$(wildcard tests/kernel/guest/*)) docs/examples/sensors.table
# The suite addon alone has these
RIG_ADDON   := $(B)/kernel/addon.tar board/addon/apparmor.txt

.PHONY: test-kernel addon-root bench-kernel endurance-kernel kernel-programs test-gpio test-gpio-pi gpio-libraries gpio-programs

$(B)/unit/test_usbip: $(B)/tests/kernel/usbip.o
$(B)/unit/test_tiny_usb: $(B)/tests/kernel/tiny_usb.o
$(B)/unit/test_vhci: $(B)/tests/kernel/vhci.o $(B)/tests/kernel/usbip.o

$(B)/kernel/simchip: $(B)/tests/kernel/simchip.o $(RIG_FRONT) $(B)/core.a $(B)/with/ld
	$(call link)

$(B)/kernel/owdump: $(B)/tests/kernel/owdump.o $(B)/tests/kernel/lines.o $(B)/with/ld
	$(call link)

$(B)/kernel/busdump: $(B)/tests/kernel/busdump.o $(B)/tests/kernel/lines.o $(B)/core.a $(B)/with/ld
	$(call link)

$(B)/kernel/owwalk: $(B)/tests/kernel/owwalk.o $(B)/tests/bench/walk.o $(B)/tests/bench/aid.o \
                    $(B)/core.a $(B)/with/ld
	$(call link)

$(ENDURANCE): $(patsubst %,$(B)/tests/kernel/%.o,endurance endurance_truth endurance_daemon \
              endurance_faces endurance_reader control) $(B)/core.a $(B)/with/ld
	$(call link)

kernel-programs: all $(RIG_OURS)

rig = tests/kernel/boot --time $(KERNEL_TIME) $(if $(OR_SKIP),--or-skip) $(RIG_OURS:%=--program %) $(RIG_PEERS:%=--program %) \
          $(RIG_GUEST:%=--file %) $(RIG_ADDON:%=--file %) $(1)

# With OR_SKIP=1 a package that cannot be had does not end it: boot then counts the suites as skipped
test-kernel: SUITES ?= detect kernel owserver faults daemon ways netlink w1 w1daemon w1por drivers usb usbdaemon record addon
test-kernel: WITH_ADDON = $(filter addon,$(SUITES))
test-kernel:
	@sh board/install-deps build kernel $(if $(WITH_ADDON),addon broker) $(if $(OR_SKIP),|| true)
	@$(MAKE) --no-print-directory kernel-programs
	@$(if $(WITH_ADDON),$(MAKE) --no-print-directory addon-root $(if $(OR_SKIP),|| true))
	@$(call rig,$(SUITES))

# The container of the add-on, and what loads its profile, which is not installed
addon-root: all
	@mkdir -p $(B)/kernel
	@rm -rf $(B)/kernel/apparmor $(B)/kernel/addon
	@sh board/fetch-debs -x - $$(dpkg --print-architecture) $(B)/kernel/apparmor apparmor
	@find $(B)/kernel/apparmor -name apparmor_parser -exec cp -t $(B)/kernel {} +
	@$(MAKE) -s install DESTDIR=$(abspath $(B))/kernel/addon PREFIX=/usr >/dev/null
	@sh tests/kernel/addon $(B)/kernel/addon $(B)/kernel/addon.tar

# Of the properties of all devices one in SHARE is read: with 1 owserver alone takes most of an hour
SHARE ?= 10
bench-kernel:
	@sh board/install-deps build kernel
	@$(MAKE) --no-print-directory kernel-programs
	@mkdir -p $(B)/kernel/share
	@echo $(SHARE) >$(B)/kernel/share/devices-share
	@$(call rig,$(or $(SUITES),bench devices)) --file $(B)/kernel/share/devices-share

# The life of owsd and all programs beside it in real time: MINUTES=60 SEED=1. Its end is within two minutes of that
MINUTES ?= 60
endurance-kernel:
	@sh board/install-deps build kernel broker addon modbus $(if $(OR_SKIP),|| true)
	@$(MAKE) --no-print-directory kernel-programs $(ENDURANCE)
	@mkdir -p $(B)/kernel/minutes
	@echo $(MINUTES) $(or $(SEED),1) >$(B)/kernel/minutes/endurance
	@$(call rig,endurance) --program $(ENDURANCE) --file $(B)/kernel/minutes/endurance
endurance-kernel: KERNEL_TIME = $(shell expr $(MINUTES) '*' 60 + 600)

# --- GPIO: an arm64 guest, whose chip is a PL061, with libgpiod 1.6 and 2.x -------------------
# Both generations of libgpiod, unpacked from Debian's packages; their library names differ, so
# one guest has both. libgpiod is all that differs between the two owsd.
ARM64    := build/arm64
GPIOD_1  := $(abspath build/gpiod-1-arm64)
GPIOD_2  := $(abspath build/gpiod-2-arm64)
GPIOD_LIB := usr/lib/aarch64-linux-gnu
# gcc for arm64 and gcc-multilib, which make m32 wants, do not go together; clang goes with both
ARM64_CC ?= $(or $(shell command -v aarch64-linux-gnu-gcc),clang --target=aarch64-linux-gnu)
ARM64_MAKE = $(MAKE) --no-print-directory B=$(ARM64) CC='$(CCACHE)$(ARM64_CC)' \
    AR=aarch64-linux-gnu-ar LIBI2C=0 LIBGPIOD=1 LIBGPIOD_CFLAGS='-isystem $(GPIOD_1)/usr/include' \
    LIBGPIOD_LIBS='-L$(GPIOD_1)/$(GPIOD_LIB) -lgpiod'
# Without libraries
ARM64_PLAIN := build/arm64-plain
ARM64_PLAIN_MAKE = $(MAKE) --no-print-directory B=$(ARM64_PLAIN) CC='$(CCACHE)$(ARM64_CC)' \
    AR=aarch64-linux-gnu-ar LIBI2C=0 LIBGPIOD=0

$(GPIOD_1)/usr/include/gpiod.h: board/fetch-debs
	@sh board/fetch-debs -x bookworm arm64 $(GPIOD_1) libgpiod-dev libgpiod2
	@touch $@
$(GPIOD_2)/usr/include/gpiod.h: board/fetch-debs
	@sh board/fetch-debs -x trixie arm64 $(GPIOD_2) libgpiod-dev libgpiod3
	@touch $@

# In build/arm64 only: owsd-sim with the other library in place of the archive's
$(B)/gpiod-2/library.o: hal/gpio/library_v2.c $(B)/with/cc
	@mkdir -p $(@D)
	$(call show,CC)
	$(Q)$(CC) -isystem $(GPIOD_2)/usr/include $(ALL_CFLAGS) -UOWSD_LIBGPIOD -DOWSD_LIBGPIOD=2 -MMD -MP -c -o $@ $<
$(B)/gpiod-2/owsd: $(B)/src/daemon/owsd/owsd.o $(call obj,$(SIM_TABLE)) $(B)/gpiod-2/library.o $(B)/core.a $(B)/with/ld
	$(call link,-L$(GPIOD_2)/$(GPIOD_LIB))
$(B)/owsd-gpiod-1: $(B)/owsd-sim
	@ln -f $< $@
$(B)/owsd-gpiod-2: $(B)/gpiod-2/owsd
	@ln -f $< $@

gpio-libraries: $(GPIOD_1)/usr/include/gpiod.h $(GPIOD_2)/usr/include/gpiod.h

GPIO_PROGRAMS := $(addprefix $(ARM64)/,owsd-gpiod-1 owsd-gpiod-2 owsctl)
gpio-programs: gpio-libraries
	@+$(ARM64_MAKE) $(GPIO_PROGRAMS)

# A compiler or packages that cannot be had are skips with OR_SKIP=1; what does not compile is not
define test_gpio
	@sh board/install-deps build arm64 $(if $(OR_SKIP),|| true)
	@+$(if $(OR_SKIP),! echo 'int main(void) { return 0; }' | $(ARM64_CC) -x c -o /dev/null - 2>/dev/null || \
	    ! $(MAKE) --no-print-directory gpio-libraries ||) $(MAKE) --no-print-directory gpio-programs
	@tests/kernel/boot --arch $(1) --time $(KERNEL_TIME) $(if $(OR_SKIP),--or-skip) \
	    --libraries $(GPIOD_1)/$(GPIOD_LIB) --libraries $(GPIOD_2)/$(GPIOD_LIB) \
	    $(GPIO_PROGRAMS:%=--program %) $(RIG_GUEST:%=--file %) $(2)
endef

test-gpio:
	$(call test_gpio,arm64,gpio)
# On a Raspberry Pi 3 as QEMU plays it
test-gpio-pi:
	$(call test_gpio,raspi3b,gpio-pi)
