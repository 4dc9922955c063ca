/* SPDX-License-Identifier: MIT */
/*
 * Soft devices of Inferno Embedded: lights, switches, relays. Of the updater of their firmware owsd
 * says what it is, and refuses the rest: half a firmware leaves no device. A command ends with the
 * CRC8 of the ROM id and of itself; the device answers 0 if it has taken it, then bytes without a
 * checksum, which are read AREA_LOOKS times. What a command does is proved by the device's own
 * answer, for it checks the command. No data sheet could be had: the commands are those of OWFS's
 * driver.
 *
 * The activations of switches, which a read clears, have nothing but that answer: a bit turned over
 * in them is not seen.
 */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/format.h"
#include "hal/owfs/path.h"

/* device.kind */
enum { IS_LIGHTS = 1, IS_UPDATER, IS_SWITCHES, IS_OTHER };

enum inferno_port { INFERNO_SWITCH, INFERNO_LED, INFERNO_STATE, INFERNO_MODE, INFERNO_TIMEOUT };
#define INFERNO_PORT(what, port) ((what) << 8 | (port))

#define PORTS_MOST 8
#define CHANNELS 32
#define ARGS 8

#define DEVICE 0xff
enum { SET_LIGHT = 0x03, GET_LIGHT, COMMIT };
enum { COUNT_SWITCHES = 0x01, COUNT_LEDS, COUNT_RELAYS, SET_TYPE, GET_ACTIVATED = 0x06 };

struct inferno {
	uint8_t counts[3][2]; /* switches, LEDs, relays: ports, channels; 0: not known */
	int64_t fetched_ns;   /* when the device gave the activations; 0: it has not yet */
	uint32_t activated[PORTS_MOST];
};
_Static_assert(sizeof(struct inferno) <= DEVICE_OWN, "no room for what is known");

/* From call to call. */
struct asked {
	uint8_t looks, stage, channel;
	uint8_t seen[CHANNELS];
};

static AREA_NAMED(identification, "device", .size = 4, .block = 4, .read = DEVICE);

static struct inferno *inferno_of(const struct txn *txn)
{
	return txn->device->own;
}

/* family.identify */
static int inferno_identify(struct txn *txn)
{
	uint8_t bytes[4];
	int err = area_read(txn, &identification, 0, bytes, sizeof(bytes));

	if (err)
		return err;
	if (bytes[3] == 0xff)
		return -EBADMSG;
	bool known = bytes[0] > 0 && bytes[0] < IS_OTHER && !bytes[1];
	txn->device->kind = known ? bytes[0] : IS_OTHER;
	return 0;
}

/*
 * The command, its n bytes and their checksum; the device answers 0 and in_n bytes. These are read
 * at once: on a wire with other masters only the answer proves that the bytes after it are its own.
 */
static int inferno_exchange(struct txn *txn, uint8_t code, const uint8_t *args, unsigned n,
                            uint8_t *in, unsigned in_n)
{
	uint8_t bytes[8 + 1 + ARGS + 1], answer[1 + PORTS_MOST * CHANNELS];
	int err;

	memcpy(bytes, txn->device->rom, 8);
	bytes[8] = code;
	if (n)
		memcpy(bytes + 9, args, n);
	bytes[9 + n] = rom_crc8(bytes, 9 + n);
	err = txn_command(txn, bytes + 8, 2 + n);
	if (!err)
		err = txn_read(txn, answer, 1 + in_n);
	if (err)
		return err;
	if (in_n)
		memcpy(in, answer + 1, in_n);
	return answer[0] ? -EBADMSG : 0;
}

static int inferno_send(struct txn *txn, uint8_t code, const uint8_t *args, unsigned n)
{
	return inferno_exchange(txn, code, args, n, NULL, 0);
}

/* The n bytes of the answer after `skip`, to asked->seen; TXN_MORE until enough looks agree. */
static int inferno_ask(struct txn *txn, uint8_t code, const uint8_t *args, unsigned args_n,
                       unsigned skip, unsigned n)
{
	struct asked *asked = txn_own(txn, struct asked);
	uint8_t in[PORTS_MOST * CHANNELS];
	int err = skip + n > sizeof(in) ? -EIO
	                                : inferno_exchange(txn, code, args, args_n, in, skip + n);

	if (err)
		return err;
	if (asked->looks && memcmp(asked->seen, in + skip, n) != 0)
		return -EBADMSG;
	memcpy(asked->seen, in + skip, n);
	if (++asked->looks < AREA_LOOKS)
		return TXN_MORE;
	asked->looks = 0;
	return 0;
}

/* 0: it is known how many ports and channels there are of it. */
static int inferno_count(struct txn *txn, unsigned which)
{
	const struct asked *asked = txn_own(txn, struct asked);
	uint8_t *counts = inferno_of(txn)->counts[which];

	if (counts[0])
		return 0;
	int err = inferno_ask(txn, (uint8_t)(COUNT_SWITCHES + which), NULL, 0, 0, 2);
	if (err)
		return err;
	if (!asked->seen[0] || asked->seen[1] > CHANNELS)
		return -EIO;
	memcpy(counts, asked->seen, 2);
	return TXN_MORE;
}

static unsigned what_of(const struct txn *txn)
{
	return (unsigned)txn->property->arg >> 8;
}

static unsigned port_of(const struct txn *txn)
{
	return (unsigned)txn->property->arg & 0xff;
}

/* State, mode and timeout are the relays'. */
static unsigned counted(const struct txn *txn)
{
	return what_of(txn) < INFERNO_STATE ? what_of(txn) : INFERNO_STATE;
}

/* arg: INFERNO_PORT(what, port); a count: INFERNO_PORT(what, 0: ports, 1: channels). */
static int inferno_read_count(struct txn *txn)
{
	const struct asked *asked = txn_own(txn, struct asked);
	int err;

	if (txn->device->kind == IS_LIGHTS) {
		err = inferno_ask(txn, 0x02, NULL, 0, 0, 1);
		txn->number[0] = asked->seen[0];
		return err;
	}
	err = inferno_count(txn, counted(txn));
	txn->number[0] = inferno_of(txn)->counts[counted(txn)][port_of(txn)];
	return err;
}

static int put_list(struct txn *txn, const uint8_t *values, unsigned n)
{
	char text[4 * CHANNELS + 1] = "";
	size_t len = 0;

	for (unsigned i = 0; i < n; i++)
		len += (size_t)snprintf(text + len, sizeof(text) - len, "%s%u", i ? "," : "",
		                        values[i]);
	return property_text(txn, text);
}

static int put_bits(struct txn *txn, uint32_t bits, unsigned n)
{
	uint8_t values[CHANNELS];

	for (unsigned i = 0; i < n; i++)
		values[i] = bits >> i & 1;
	return put_list(txn, values, n);
}

static int inferno_read_port(struct txn *txn)
{
	static const uint8_t codes[] = {0, 0x08, 0x0c, 0x0d, 0x0e};
	const struct asked *asked = txn_own(txn, struct asked);
	const uint8_t port = (uint8_t)port_of(txn);
	uint32_t bits = 0;
	int err = inferno_count(txn, counted(txn));

	if (err)
		return err;
	const uint8_t *counts = inferno_of(txn)->counts[counted(txn)];
	unsigned n = counts[1], bytes = (n + 7) / 8;

	if (port >= counts[0])
		return -ENOENT;
	if (what_of(txn) == INFERNO_SWITCH) {
		if (!inferno_of(txn)->fetched_ns)
			return -EIO;
		txn->measured_ns = inferno_of(txn)->fetched_ns;
		return put_bits(txn, inferno_of(txn)->activated[port], n);
	}
	if (what_of(txn) == INFERNO_LED) {
		err = inferno_ask(txn, codes[INFERNO_LED], &port, 1, 0, bytes);
		for (unsigned i = 0; i < bytes && !err; i++)
			bits |= (uint32_t)asked->seen[i] << 8 * i;
		return err ? err : put_bits(txn, bits, n);
	}
	err = inferno_ask(txn, codes[what_of(txn)], NULL, 0, port * n, n);
	return err ? err : put_list(txn, asked->seen, n);
}

/* Number i of the list that is written; -EINVAL: it is none, -ENOENT: the list has ended. */
static int list_number(const struct txn *txn, unsigned i, uint32_t most)
{
	const char *part;
	char text[16] = "", *end;
	size_t len;

	if (!list_part((const char *)txn->data, txn->len, i, &part, &len))
		return -ENOENT;
	if (len == 0 || len >= sizeof(text))
		return -EINVAL;
	memcpy(text, part, len);
	unsigned long value = strtoul(text, &end, 10);

	while (isspace((unsigned char)*end))
		end++;
	return *end || strchr(text, '-') || value > most ? -EINVAL : (int)value;
}

/* All numbers fit before one is sent; there are n at the most. */
static int check_list(const struct txn *txn, unsigned n, uint32_t most)
{
	unsigned i = 0;
	int value;

	while ((value = list_number(txn, i, most)) >= 0)
		i++;
	return txn->at || value != -ENOENT || i == 0 || i > n ? -EINVAL : 0;
}

/* Channel by channel, as many as the list has. */
static int inferno_write_port(struct txn *txn)
{
	static const uint8_t codes[] = {0, 0x07, 0x0b, 0x09, 0x0a};
	struct asked *asked = txn_own(txn, struct asked);
	uint32_t most = what_of(txn) == INFERNO_LED ? 1 : 255;
	int value, err = inferno_count(txn, counted(txn));

	if (err)
		return err;
	const uint8_t *counts = inferno_of(txn)->counts[counted(txn)];
	if (port_of(txn) >= counts[0])
		return -ENOENT;
	if (asked->channel == 0 && check_list(txn, counts[1], most))
		return -EINVAL;
	value = list_number(txn, asked->channel, most);
	if (value < 0)
		return 0;
	const uint8_t args[] = {(uint8_t)port_of(txn), asked->channel, (uint8_t)value};

	err = inferno_send(txn, codes[what_of(txn)], args, sizeof(args));
	asked->channel++;
	return err ? err : TXN_MORE;
}

/* "port,channel,type" */
static int inferno_set_type(struct txn *txn)
{
	int err = inferno_count(txn, INFERNO_SWITCH);

	if (err)
		return err;
	if (check_list(txn, 3, 255) || list_number(txn, 2, 3) < 0)
		return -EINVAL;
	const uint8_t args[] = {(uint8_t)list_number(txn, 0, 255),
	                        (uint8_t)list_number(txn, 1, 255), (uint8_t)list_number(txn, 2, 3)};
	const uint8_t *counts = inferno_of(txn)->counts[INFERNO_SWITCH];

	if (args[0] >= counts[0] || args[1] >= counts[1])
		return -EINVAL;
	return inferno_send(txn, SET_TYPE, args, sizeof(args));
}

/* It clears what it reads: it is read once, and nothing proves the bytes. */
static int inferno_refresh(struct txn *txn)
{
	struct inferno *inferno = inferno_of(txn);
	uint8_t bytes[PORTS_MOST * 4];
	int err = inferno_count(txn, INFERNO_SWITCH);

	if (err || txn->number[0] == 0)
		return err;
	unsigned ports = inferno->counts[INFERNO_SWITCH][0];
	unsigned each = (inferno->counts[INFERNO_SWITCH][1] + 7u) / 8;

	ports = ports < PORTS_MOST ? ports : PORTS_MOST;
	err = inferno_exchange(txn, GET_ACTIVATED, NULL, 0, bytes, ports * each);
	if (err)
		return err;
	memset(inferno->activated, 0, sizeof(inferno->activated));
	for (unsigned i = 0; i < ports * each; i++)
		inferno->activated[i / each] |= (uint32_t)bytes[i] << 8 * (i % each);
	inferno->fetched_ns = txn_now(txn);
	return 0;
}

/* Red, green, blue, white, and the ms that its fade takes: it is read when that is over. */
static int inferno_read_light(struct txn *txn)
{
	const uint8_t channel = (uint8_t)txn->property->arg;
	const struct asked *asked = txn_own(txn, struct asked);
	const uint8_t *in = asked->seen;
	char text[40];
	int err = inferno_ask(txn, GET_LIGHT, &channel, 1, 0, 7);

	if (err)
		return err;
	snprintf(text, sizeof(text), "%3d,%3d,%3d,%3d,%8d", in[0], in[1], in[2], in[3],
	         in[4] | in[5] << 8 | in[6] << 16);
	return property_text(txn, text);
}

static int inferno_write_light(struct txn *txn)
{
	struct asked *asked = txn_own(txn, struct asked);
	uint8_t args[ARGS] = {(uint8_t)txn->property->arg};
	int fade, err;

	if (asked->stage)
		return inferno_send(txn, COMMIT, NULL, 0);
	fade = list_number(txn, 4, 0xffffff);
	if (fade < 0 || check_list(txn, 5, 0xffffff))
		return -EINVAL;
	for (unsigned i = 0; i < 4; i++) {
		if (list_number(txn, i, 255) < 0)
			return -EINVAL;
		args[1 + i] = (uint8_t)list_number(txn, i, 255);
	}
	for (unsigned i = 0; i < 3; i++)
		args[5 + i] = (uint8_t)(fade >> 8 * i);
	err = inferno_send(txn, SET_LIGHT, args, sizeof(args));
	asked->stage = 1;
	return err ? err : TXN_MORE;
}

/* arg: the command, which has no bytes. */
static int inferno_command(struct txn *txn)
{
	return txn->number[0] != 0 ? inferno_send(txn, (uint8_t)txn->property->arg, NULL, 0) : 0;
}

static int inferno_read_device(struct txn *txn)
{
	static const char *const names[] = {"", "Inferno Embedded RGBW Controller",
	                                    "Inferno Embedded Firmware Updater",
	                                    "Inferno Embedded Switch Master", "unknown"};

	return property_text(txn, names[txn->device->kind]);
}

/* Numbers have their low byte first. */
enum { STATUS = 1, VERSION };
static const struct area *const areas[] = {
	[STATUS] = AREA(.name = "status", .size = 8, .block = 8, .read = 0xfd),
	[VERSION] = AREA(.name = "version", .size = 4, .block = 4, .read = 0xfe),
};

/* clang-format off */
enum { WAY_DEVICE = 1, WAY_FIRMWARE, WAY_COUNT, WAY_PORT, WAY_TYPE, WAY_REFRESH, WAY_LIGHT,
       WAY_COMMAND };
static const struct property_how how[] = {
	[WAY_DEVICE] = {.read = inferno_read_device},
	[WAY_FIRMWARE] = {.read = property_refuse, .write = property_refuse},
	[WAY_COUNT] = {.read = inferno_read_count},
	[WAY_PORT] = {.read = inferno_read_port, .write = inferno_write_port},
	[WAY_TYPE] = {.write = inferno_set_type},
	[WAY_REFRESH] = {.write = inferno_refresh},
	[WAY_LIGHT] = {.read = inferno_read_light, .write = inferno_write_light},
	[WAY_COMMAND] = {.write = inferno_command},
};

#define LIGHTS .kinds = KIND(IS_LIGHTS)
#define UPDATER .kinds = KIND(IS_UPDATER)
#define SWITCHES .kinds = KIND(IS_SWITCHES)
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
	PROPERTY("enter_firmware_update", YESNO, STATIC, WRITE, .how = WAY_FIRMWARE),
	PROPERTY("erase_firmware", YESNO, VOLATILE, WRITE, UPDATER, .how = WAY_FIRMWARE),
	PROPERTY("exit_firmware_update", YESNO, VOLATILE, WRITE, UPDATER, .how = WAY_FIRMWARE),
	PROPERTY("firmware_bootloader_size", UNSIGNED, VOLATILE, READ, UPDATER, .how = WAY_FIRMWARE),
	PROPERTY("firmware_range", ASCII, VOLATILE, READ, UPDATER, .size = 22, .how = WAY_FIRMWARE),
	COUNT("led_channels", LED, 1),
	PORTS("led_port", BOTH, 129, LED),
	COUNT("led_ports", LED, 0),
	COUNT("relay_channels", STATE, 1),
	PORTS("relay_mode", BOTH, 129, MODE),
	PORTS("relay_port", BOTH, 257, STATE),
	COUNT("relay_ports", STATE, 0),
	PORTS("relay_timeout", BOTH, 257, TIMEOUT),
	PROPERTY("rgbw_all_off", YESNO, STATIC, WRITE, LIGHTS, .arg = 0x01, .how = WAY_COMMAND),
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
