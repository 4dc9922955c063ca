# SPDX-License-Identifier: MIT
# The kernel rig: Debian's own kernel in QEMU, a simulated chip behind a real I2C adapter.
# SUITES picks from tests/kernel/guest; KERNEL_TIME bounds each guest, in seconds; OR_SKIP=1 counts
# suites as skipped that cannot run for want of QEMU, the kernel's package or the peers.

KERNEL_TIME ?= 600
RIG_FRONT   := $(B)/tests/kernel/vhci.o $(B)/tests/kernel/usbip.o $(B)/tests/kernel/tiny_usb.o \
               $(B)/tests/kernel/control.o
RIG_OURS    := $(B)/kernel/simchip $(B)/kernel/owdump $(B)/kernel/busdump $(PROGRAMS)
RIG_PEERS    = $(foreach p,owserver i2cdetect i2cget i2cset i2ctransfer,\
                 $(shell PATH="$$PATH:/usr/sbin" command -v $(p)))
RIG_GUEST   := $(filter-out %/init,$(wildcard tests/kernel/guest/*))

.PHONY: test-kernel bench-kernel kernel-programs

$(B)/unit/test_usbip: $(B)/tests/kernel/usbip.o
$(B)/unit/test_tiny_usb: $(B)/tests/kernel/tiny_usb.o

$(B)/kernel/simchip: $(B)/tests/kernel/simchip.o $(RIG_FRONT) $(B)/core.a
	@mkdir -p $(@D)
	$(CC) $(ALL_LDFLAGS) -o $@ $^ $(LIBS)

$(B)/kernel/owdump: $(B)/tests/kernel/owdump.o $(B)/tests/kernel/lines.o
	@mkdir -p $(@D)
	$(CC) $(ALL_LDFLAGS) -o $@ $^ $(LIBS)

$(B)/kernel/busdump: $(B)/tests/kernel/busdump.o $(B)/tests/kernel/lines.o $(B)/core.a
	@mkdir -p $(@D)
	$(CC) $(ALL_LDFLAGS) -o $@ $^ $(LIBS)

kernel-programs: all $(RIG_OURS)

rig = tests/kernel/boot --time $(KERNEL_TIME) $(if $(OR_SKIP),--or-skip) $(RIG_OURS:%=--program %) $(RIG_PEERS:%=--program %) \
          $(RIG_GUEST:%=--file %) $(1)

# With OR_SKIP=1 a package that cannot be had does not end it: boot then counts the suites as skipped
test-kernel: SUITES ?= detect kernel owserver faults daemon ways netlink
test-kernel:
	@sh board/install-deps build kernel $(if $(OR_SKIP),|| true)
	@$(MAKE) --no-print-directory kernel-programs
	@$(call rig,$(SUITES))

bench-kernel:
	@sh board/install-deps build kernel
	@$(MAKE) --no-print-directory kernel-programs
	@$(call rig,bench)
