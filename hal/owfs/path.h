/* SPDX-License-Identifier: MIT */
/*
 * OWFS paths and device ids. Nothing here allocates, blocks or keeps state; a split path points
 * into the text that was split.
 *
 *     [/uncached][/alarm][/bus.N][/text]/device/property
 *
 * owhttpd puts text or json in front, which owsd ignores. The leading "/" may be absent. The device
 * is a ROM id in one of the six formats of OWFS or an alias; below a DS2409 coupler the device has
 * several components (/1F.x/main/28.y). The property may have directories (HIH4000/humidity).
 *
 * Room hal/owfs: the paths of OWFS, and the frames of its protocol.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PATH_LEN_MAX 255

/*
 * Family, six bytes of id, CRC8: the order in which they are on the wire and in "28.551DDF030000".
 */
#define ROM_LEN 8

/* Dallas CRC8 (x^8 + x^5 + x^4 + 1, least bit first, from 0); 0 over data and its CRC. */
uint8_t rom_crc8(const uint8_t *data, size_t len);

enum rom_format {
	ROM_F_I,   /* 28.551DDF030000, what owserver shows by default */
	ROM_FI,    /* 28551DDF030000 */
	ROM_F_I_C, /* 28.551DDF030000.1F */
	ROM_F_IC,  /* 28.551DDF0300001F */
	ROM_FI_C,  /* 28551DDF030000.1F */
	ROM_FIC,   /* 28551DDF0300001F */
};
#define ROM_TEXT_MAX 19 /* with NUL */

/*
 * Read a ROM id in any of the formats, hex in any case; where the text has no CRC, it is computed.
 * 0; -EINVAL: the text has none of the formats (it is an alias); -EBADMSG: the text has a format,
 * but the CRC is wrong or the family is 00.
 */
int rom_parse(const char *text, size_t len, uint8_t rom[ROM_LEN]);
/* Print a ROM id in a format, upper case. Returns the length. */
int rom_print(const uint8_t rom[ROM_LEN], enum rom_format format, char text[ROM_TEXT_MAX]);

/* A part of the text, not NUL-terminated; len 0: absent. */
struct path_slice {
	const char *text;
	size_t len;
};

struct path {
	bool uncached, alarm;
	int bus;                    /* N of bus.N, -1: none */
	struct path_slice device;   /* "28.551DDF030000", "1F.x/main/28.y", alias; absent in
	                               /simultaneous/temperature and the like */
	struct path_slice last;     /* the last component of device */
	struct path_slice property; /* "temperature12", "HIH4000/humidity" */
	bool has_rom;               /* last is a ROM id, not an alias */
	uint8_t rom[ROM_LEN];
};

/*
 * Split len bytes of text. Returns NULL, or the fault as the end of a message that names the path
 * before ("has an empty component"); *path is then undefined. "" and "/" are the root: no device,
 * no property.
 */
const char *path_split(const char *text, size_t len, struct path *path);

/* The value of a hexadecimal digit, -1: it is none. */
int hex_digit(char c);
/* Is the component a branch of a coupler, main or aux? */
bool path_is_branch(struct path_slice slice);

/*
 * Do both paths name the same device? ROM ids are compared as ids, so format and branch do not
 * matter; aliases by their letters. False when only one of the two is an alias, or when a path has
 * no device.
 */
bool path_same_device(const struct path *a, const struct path *b);
