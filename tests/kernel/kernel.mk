# SPDX-License-Identifier: MIT
# The kernel rig: Debian's own kernel in QEMU, a simulated chip behind a real I2C adapter.

$(B)/unit/test_usbip: $(B)/tests/kernel/usbip.o
$(B)/unit/test_tiny_usb: $(B)/tests/kernel/tiny_usb.o

$(B)/kernel/owdump: $(B)/tests/kernel/owdump.o
	@mkdir -p $(@D)
	$(CC) $(ALL_LDFLAGS) -o $@ $^ $(LIBS)
