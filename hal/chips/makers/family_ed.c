/* SPDX-License-Identifier: MIT */
/*
 * Soft devices of Inferno Embedded (inferno.h). No data sheet could be had: the commands are those
 * of OWFS's driver.
 */
#include "hal/chips/makers/inferno.h"

/* Numbers have their low byte first. */
static const struct area status = {.name = "status", .size = 8, .block = 8, .read = 0xfd};
static const struct area version = {.name = "version", .size = 4, .block = 4, .read = 0xfe};

/* It comes up as what its firmware makes of it. */
static int exit_update(struct txn *txn)
{
	int err = inferno_command(txn);

	if (!err && txn->number[0] != 0)
		family_forget(txn->device);
	return err;
}

enum { STATUS = 1, VERSION };
static const struct area *const areas[] = {[STATUS] = &status, [VERSION] = &version};

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
#define LIGHT(text, channel) \
	PROPERTY(text, ASCII, VOLATILE, BOTH, LIGHTS, .size = 25, .arg = (channel), .how = WAY_LIGHT)

static const struct property properties[] = {
	PROPERTY("device", ASCII, VOLATILE, READ, .size = 64, .how = WAY_DEVICE),
	PROPERTY("enter_firmware_update", YESNO, STATIC, WRITE, .how = WAY_ENTER),
	PROPERTY("erase_firmware", YESNO, VOLATILE, WRITE, UPDATER, .how = WAY_FIRMWARE),
	PROPERTY("exit_firmware_update", YESNO, VOLATILE, WRITE, UPDATER, .arg = 0x05,
	         .how = WAY_EXIT),
	PROPERTY("firmware_bootloader_size", UNSIGNED, VOLATILE, READ, UPDATER, .how = WAY_SIZE),
	PROPERTY("firmware_range", ASCII, VOLATILE, READ, UPDATER, .size = 22, .how = WAY_RANGE),
	COUNT("led_channels", LED, 1),
	PORT("led_port0", BOTH, 129, LED, 0),
	PORT("led_port1", BOTH, 129, LED, 1),
	PORT("led_port2", BOTH, 129, LED, 2),
	PORT("led_port3", BOTH, 129, LED, 3),
	PORT("led_port4", BOTH, 129, LED, 4),
	PORT("led_port5", BOTH, 129, LED, 5),
	PORT("led_port6", BOTH, 129, LED, 6),
	PORT("led_port7", BOTH, 129, LED, 7),
	COUNT("led_ports", LED, 0),
	COUNT("relay_channels", STATE, 1),
	PORT("relay_mode0", BOTH, 129, MODE, 0),
	PORT("relay_mode1", BOTH, 129, MODE, 1),
	PORT("relay_mode2", BOTH, 129, MODE, 2),
	PORT("relay_mode3", BOTH, 129, MODE, 3),
	PORT("relay_mode4", BOTH, 129, MODE, 4),
	PORT("relay_mode5", BOTH, 129, MODE, 5),
	PORT("relay_mode6", BOTH, 129, MODE, 6),
	PORT("relay_mode7", BOTH, 129, MODE, 7),
	PORT("relay_port0", BOTH, 257, STATE, 0),
	PORT("relay_port1", BOTH, 257, STATE, 1),
	PORT("relay_port2", BOTH, 257, STATE, 2),
	PORT("relay_port3", BOTH, 257, STATE, 3),
	PORT("relay_port4", BOTH, 257, STATE, 4),
	PORT("relay_port5", BOTH, 257, STATE, 5),
	PORT("relay_port6", BOTH, 257, STATE, 6),
	PORT("relay_port7", BOTH, 257, STATE, 7),
	COUNT("relay_ports", STATE, 0),
	PORT("relay_timeout0", BOTH, 257, TIMEOUT, 0),
	PORT("relay_timeout1", BOTH, 257, TIMEOUT, 1),
	PORT("relay_timeout2", BOTH, 257, TIMEOUT, 2),
	PORT("relay_timeout3", BOTH, 257, TIMEOUT, 3),
	PORT("relay_timeout4", BOTH, 257, TIMEOUT, 4),
	PORT("relay_timeout5", BOTH, 257, TIMEOUT, 5),
	PORT("relay_timeout6", BOTH, 257, TIMEOUT, 6),
	PORT("relay_timeout7", BOTH, 257, TIMEOUT, 7),
	PROPERTY("rgbw_all_off", YESNO, STATIC, WRITE, LIGHTS,
	         .arg = 0x01, .how = WAY_COMMAND),
	LIGHT("rgbw_channel0", 0),
	LIGHT("rgbw_channel1", 1),
	LIGHT("rgbw_channel10", 10),
	LIGHT("rgbw_channel11", 11),
	LIGHT("rgbw_channel12", 12),
	LIGHT("rgbw_channel13", 13),
	LIGHT("rgbw_channel14", 14),
	LIGHT("rgbw_channel15", 15),
	LIGHT("rgbw_channel16", 16),
	LIGHT("rgbw_channel17", 17),
	LIGHT("rgbw_channel18", 18),
	LIGHT("rgbw_channel19", 19),
	LIGHT("rgbw_channel2", 2),
	LIGHT("rgbw_channel20", 20),
	LIGHT("rgbw_channel21", 21),
	LIGHT("rgbw_channel22", 22),
	LIGHT("rgbw_channel23", 23),
	LIGHT("rgbw_channel24", 24),
	LIGHT("rgbw_channel25", 25),
	LIGHT("rgbw_channel26", 26),
	LIGHT("rgbw_channel27", 27),
	LIGHT("rgbw_channel28", 28),
	LIGHT("rgbw_channel29", 29),
	LIGHT("rgbw_channel3", 3),
	LIGHT("rgbw_channel30", 30),
	LIGHT("rgbw_channel31", 31),
	LIGHT("rgbw_channel4", 4),
	LIGHT("rgbw_channel5", 5),
	LIGHT("rgbw_channel6", 6),
	LIGHT("rgbw_channel7", 7),
	LIGHT("rgbw_channel8", 8),
	LIGHT("rgbw_channel9", 9),
	PROPERTY("rgbw_channels", UNSIGNED, STATIC, READ, LIGHTS, .how = WAY_COUNT),
	PROPERTY("set_switch_type", ASCII, VOLATILE, WRITE, SWITCHES, .size = 9, .how = WAY_TYPE),
	PROPERTY("status", UNSIGNED, VOLATILE, READ, FIELD(STATUS, .bytes = 4)),
	COUNT("switch_channels", SWITCH, 1),
	PORT("switch_port0", READ, 129, SWITCH, 0),
	PORT("switch_port1", READ, 129, SWITCH, 1),
	PORT("switch_port2", READ, 129, SWITCH, 2),
	PORT("switch_port3", READ, 129, SWITCH, 3),
	PORT("switch_port4", READ, 129, SWITCH, 4),
	PORT("switch_port5", READ, 129, SWITCH, 5),
	PORT("switch_port6", READ, 129, SWITCH, 6),
	PORT("switch_port7", READ, 129, SWITCH, 7),
	COUNT("switch_ports", SWITCH, 0),
	PROPERTY("switch_refresh_activations", YESNO, STATIC, WRITE, SWITCHES, .how = WAY_REFRESH),
	PROPERTY("update_firmware", BINARY, VOLATILE, WRITE, UPDATER, .size = 65536, .how = WAY_FIRMWARE),
	PROPERTY("version", UNSIGNED, VOLATILE, READ, FIELD(VERSION, .bytes = 4)),
};
/* clang-format on */

static const char *const types[] = {"InfernoEmbedded", "InfernoEmbedded", "InfernoEmbedded",
                                    "InfernoEmbedded", "InfernoEmbedded"};

const struct family family_ed = {
	.code = 0xed,
	.proof = PROOF_PRESENCE,
	.type = "InfernoEmbedded",
	.flags = FLAG_RESUME,
	.kind = inferno_kind,
	.tell = inferno_identify,
	.types = types,
	AREAS(areas),
	HOW(how),
	PROPERTIES(properties),
};
