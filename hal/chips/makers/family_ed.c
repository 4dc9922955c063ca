/* SPDX-License-Identifier: MIT */
/*
 * Soft devices of Inferno Embedded (inferno.h). No data sheet could be had: the commands are those
 * of OWFS's driver.
 */
#include "hal/chips/makers/inferno.h"

/* It comes up as what its firmware makes of it. */
static int exit_update(struct txn *txn)
{
	int err = inferno_command(txn);

	if (!err && txn->number[0] != 0)
		family_forget(txn->device);
	return err;
}

/* Numbers have their low byte first. */
enum { STATUS = 1, VERSION };
static const struct area *const areas[] = {
	[STATUS] = AREA(.name = "status", .size = 8, .block = 8, .read = 0xfd),
	[VERSION] = AREA(.name = "version", .size = 4, .block = 4, .read = 0xfe),
};

enum {
	WAY_DEVICE = 1,
	WAY_ENTER,
	WAY_EXIT,
	WAY_FIRMWARE,
	WAY_SIZE,
	WAY_RANGE,
	WAY_COUNT,
	WAY_PORT,
	WAY_TYPE,
	WAY_REFRESH,
	WAY_LIGHT,
	WAY_COMMAND,
};
static const struct property_how how[] = {
	[WAY_DEVICE] = {.read = inferno_read_device},
	[WAY_ENTER] = {.write = inferno_enter_update},
	[WAY_EXIT] = {.write = exit_update},
	/* half a firmware leaves no device: not over a wire that may fail */
	[WAY_FIRMWARE] = {.write = property_refuse},
	[WAY_SIZE] = {.read = inferno_read_size},
	[WAY_RANGE] = {.read = inferno_read_range},
	[WAY_COUNT] = {.read = inferno_read_count},
	[WAY_PORT] = {.read = inferno_read_port, .write = inferno_write_port},
	[WAY_TYPE] = {.write = inferno_set_type},
	[WAY_REFRESH] = {.write = inferno_refresh},
	[WAY_LIGHT] = {.read = inferno_read_light, .write = inferno_write_light},
	[WAY_COMMAND] = {.write = inferno_command},
};

/* clang-format off */
#define LIGHTS .kinds = KIND(INFERNO_LIGHTS)
#define UPDATER .kinds = KIND(INFERNO_UPDATER)
#define SWITCHES .kinds = KIND(INFERNO_SWITCHES)
#define PORT(text, access_, bytes_, what, port) \
	PROPERTY(text, ASCII, VOLATILE, access_, SWITCHES, .size = (bytes_), \
	         .arg = INFERNO_PORT(INFERNO_##what, port), .how = WAY_PORT)
#define COUNT(text, what, which) \
	PROPERTY(text, UNSIGNED, STATIC, READ, SWITCHES, \
	         .arg = INFERNO_PORT(INFERNO_##what, which), .how = WAY_COUNT)
#define PORTS(text, access_, bytes_, what) \
	PORT(text "0", access_, bytes_, what, 0), PORT(text "1", access_, bytes_, what, 1), \
	PORT(text "2", access_, bytes_, what, 2), PORT(text "3", access_, bytes_, what, 3), \
	PORT(text "4", access_, bytes_, what, 4), PORT(text "5", access_, bytes_, what, 5), \
	PORT(text "6", access_, bytes_, what, 6), PORT(text "7", access_, bytes_, what, 7)
#define LIGHT(channel) \
	PROPERTY("rgbw_channel" #channel, ASCII, VOLATILE, BOTH, LIGHTS, .size = 25, \
	         .arg = (channel), .how = WAY_LIGHT)

static const struct property properties[] = {
	PROPERTY("device", ASCII, VOLATILE, READ, .size = 64, .how = WAY_DEVICE),
	PROPERTY("enter_firmware_update", YESNO, STATIC, WRITE, .how = WAY_ENTER),
	PROPERTY("erase_firmware", YESNO, VOLATILE, WRITE, UPDATER, .how = WAY_FIRMWARE),
	PROPERTY("exit_firmware_update", YESNO, VOLATILE, WRITE, UPDATER, .arg = 0x05,
	         .how = WAY_EXIT),
	PROPERTY("firmware_bootloader_size", UNSIGNED, VOLATILE, READ, UPDATER, .how = WAY_SIZE),
	PROPERTY("firmware_range", ASCII, VOLATILE, READ, UPDATER, .size = 22, .how = WAY_RANGE),
	COUNT("led_channels", LED, 1),
	PORTS("led_port", BOTH, 129, LED),
	COUNT("led_ports", LED, 0),
	COUNT("relay_channels", STATE, 1),
	PORTS("relay_mode", BOTH, 129, MODE),
	PORTS("relay_port", BOTH, 257, STATE),
	COUNT("relay_ports", STATE, 0),
	PORTS("relay_timeout", BOTH, 257, TIMEOUT),
	PROPERTY("rgbw_all_off", YESNO, STATIC, WRITE, LIGHTS,
	         .arg = 0x01, .how = WAY_COMMAND),
	/* in the order of their names */
	LIGHT(0), LIGHT(1), LIGHT(10), LIGHT(11), LIGHT(12), LIGHT(13), LIGHT(14), LIGHT(15),
	LIGHT(16), LIGHT(17), LIGHT(18), LIGHT(19), LIGHT(2), LIGHT(20), LIGHT(21), LIGHT(22),
	LIGHT(23), LIGHT(24), LIGHT(25), LIGHT(26), LIGHT(27), LIGHT(28), LIGHT(29), LIGHT(3),
	LIGHT(30), LIGHT(31), LIGHT(4), LIGHT(5), LIGHT(6), LIGHT(7), LIGHT(8), LIGHT(9),
	PROPERTY("rgbw_channels", UNSIGNED, STATIC, READ, LIGHTS, .how = WAY_COUNT),
	PROPERTY("set_switch_type", ASCII, VOLATILE, WRITE, SWITCHES, .size = 9, .how = WAY_TYPE),
	PROPERTY("status", UNSIGNED, VOLATILE, READ, FIELD(STATUS, .bytes = 4)),
	COUNT("switch_channels", SWITCH, 1),
	PORTS("switch_port", READ, 129, SWITCH),
	COUNT("switch_ports", SWITCH, 0),
	PROPERTY("switch_refresh_activations", YESNO, STATIC, WRITE, SWITCHES, .how = WAY_REFRESH),
	PROPERTY("update_firmware", BINARY, VOLATILE, WRITE, UPDATER, .size = 65536, .how = WAY_FIRMWARE),
	PROPERTY("version", UNSIGNED, VOLATILE, READ, FIELD(VERSION, .bytes = 4)),
};
/* clang-format on */

CHIP_FAMILY(ed, "InfernoEmbedded", PRESENCE, .flags = FLAG_RESUME, .several = true,
            .identify = inferno_identify, AREAS(areas), HOW(how), PROPERTIES(properties));
