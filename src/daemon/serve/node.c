/* SPDX-License-Identifier: MIT */
/*
 * Parses a client's path: does it name a part of the targets, a signal, a return code, or nothing?
 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/native/tables.h"
#include "src/daemon/serve/node.h"

static bool node_is(const char *text, size_t len, const char *word)
{
	return strlen(word) == len && memcmp(text, word, len) == 0;
}

bool node_is_in(const char *const *names, const char *name, size_t len)
{
	for (; *names; names++)
		if (node_is(name, len, *names))
			return true;
	return false;
}

static bool starts(const char *text, size_t len, const char *word)
{
	size_t n = strlen(word);

	return len >= n && memcmp(text, word, n) == 0 && (len == n || text[n] == '/');
}

static void find_property(struct node *node, const struct family *family, const char *name,
                          size_t len)
{
	const struct property *property;
	size_t stem;

	if (extension_split(name, len, &stem) == EXTENSION_NONE)
		stem = len;
	property = family_property(family, NULL, name, stem);
	if (!property && stem != len)
		property = family_property(family, NULL, name, len);
	if (!property)
		return;
	node->type = property->type == PROPERTY_BITS ? 'y' : (char)property->type;
	node->life = (char)property->life;
	if (property->type == PROPERTY_BINARY)
		node->bytes = property_size(property);
	if (node->bytes && extension_split(name, len, &stem) == EXTENSION_ALL)
		node->bytes *= property->array.count;
	if (extension_split(name, len, &stem) == EXTENSION_BYTE)
		node->type = 'u';
}

static void take_code(struct node *node, const char *name, size_t len)
{
	node->kind = NODE_NONE;
	if (len == 0)
		node->kind = NODE_CODES;
	if (len < 7 || memcmp(name, "/text.", 6) != 0)
		return;
	name += 6;
	len -= 6;
	node->code = node_is(name, len, "ALL") ? -1 : 0;
	for (size_t i = 0; i < len && node->code >= 0; i++) {
		if (name[i] < '0' || name[i] > '9' || len > 3)
			return;
		node->code = node->code * 10 + (name[i] - '0');
	}
	if (node->code <= 210)
		node->kind = NODE_CODE;
}

/* /alarm/alarm, /alarm/bus.0, /bus.0/bus.0: no tree has these, though a .rio file may name them. */
static bool branches_again(const char *text, size_t len)
{
	const char *end = text + len;
	bool alarm = false, bus = false;
	struct path one;

	while (text < end) {
		const char *slash = memchr(text, '/', (size_t)(end - text));
		size_t n = (size_t)((slash ? slash : end) - text);

		if (path_split(text, n, &one) || one.device.len || one.property.len)
			return false;
		if ((one.alarm && alarm) || (one.bus >= 0 && (alarm || bus)))
			return true;
		alarm |= one.alarm;
		bus |= one.bus >= 0;
		text += n + (slash != NULL);
	}
	return false;
}

/* The entry stands in the root alone: not in each bus, and not among the alarms. */
static bool is_of_the_root(const char *text, size_t len)
{
	return starts(text, len, "settings") || starts(text, len, "statistics") ||
	       starts(text, len, "structure") || starts(text, len, "system");
}

static bool is_file_of_structure(const char *text, size_t len)
{
	static const char above[] = "structure/";
	const struct property *property;
	const struct family *family;
	size_t used, stem;

	if (!starts(text, len, "structure") || len < sizeof(above))
		return false;
	text += sizeof(above) - 1;
	len -= sizeof(above) - 1;
	family = structure_family(text, len, &used);
	if (!family || used + 1 >= len)
		return false;
	text += used + 1;
	len -= used + 1;
	extension_split(text, len, &stem);
	property = family_property(family, NULL, text, stem);
	return property && !property_has_entries(property);
}

static void take_virtual(struct node *node, const struct path *split)
{
	static const char codes[] = "settings/return_codes";
	const char *text = node->path + node->device_len + 1, *slash;
	size_t len = strlen(text), word;

	node->every = node->bus < 0;
	if (((split->alarm || node->bus >= 0) && is_of_the_root(text, len)) ||
	    (node->slash && is_file_of_structure(text, len))) {
		node->kind = NODE_NONE;
		return;
	}
	if (starts(text, len, codes) && node->bus < 0) {
		take_code(node, text + sizeof(codes) - 1, len - (sizeof(codes) - 1));
		return;
	}
	slash = memchr(text, '/', len);
	word = slash ? (size_t)(slash - text) : len;
	if (slash && virtual_family(text, word))
		find_property(node, virtual_family(text, word), slash + 1, len - word - 1);
}

static void append_path(struct node *node, size_t *at, const char *text, size_t len)
{
	size_t room = sizeof(node->path) - 1 - *at;

	if (len > room)
		len = room;
	if (len)
		memcpy(node->path + *at, text, len);
	*at += len;
}

static void print_path(struct node *node, const struct path *split)
{
	const char *alarm = split->alarm && !split->device.len ? "/alarm" : "";
	struct path_slice device = split->device;
	char id[ROM_TEXT_MAX];
	size_t n = 0;

	if (split->has_rom && split->device.len == split->last.len) {
		device.len = (size_t)rom_print(split->rom, ROM_F_I, id);
		device.text = id;
	}
	append_path(node, &n, alarm, strlen(alarm));
	if (device.len) {
		append_path(node, &n, "/", 1);
		append_path(node, &n, device.text, device.len);
	}
	node->device_len = (uint16_t)n;
	if (split->property.len || !n) {
		append_path(node, &n, "/", 1);
		append_path(node, &n, split->property.text, split->property.len);
	}
	node->path[n] = '\0';
	/* /Settings is /settings */
	for (char *word = node->path + node->device_len + 1;
	     !device.len && word < node->path + n && *word != '/'; word++)
		*word = (char)tolower((unsigned char)*word);
}

void node_parse(const char *path, size_t len, struct node *node)
{
	struct path split;

	memset(node, 0, offsetof(struct node, path));
	node->path[0] = '\0';
	node->bus = -1;
	if (len > 1 && path[len - 1] == '/') {
		node->slash = true;
		len--;
	}
	if ((node->slash && path[len - 1] == '/') || path_split(path, len, &split) ||
	    ((split.alarm || split.bus >= 0) && branches_again(path, len)))
		return;
	node->kind = NODE_TARGET;
	node->fresh = node->uncached = split.uncached;
	node->bus = split.bus;
	node->has_device = split.device.len != 0;
	node->has_rom = split.has_rom;
	memcpy(node->rom, split.rom, ROM_LEN);
	print_path(node, &split);
	if (node->has_device && starts(split.device.text, split.device.len, "signals")) {
		node->kind = split.bus >= 0 || split.alarm ? NODE_NONE
		             : split.property.len          ? NODE_SIGNAL
		                                           : NODE_SIGNALS;
		node->name = node->path + sizeof("/signals");
	} else if (node->has_device) {
		if (node->has_rom && split.property.len)
			find_property(node, family_of(split.rom[0]), split.property.text,
			              split.property.len);
	} else if (split.property.len) {
		take_virtual(node, &split);
	} else {
		node->devices = true;
		node->root = split.bus < 0 && !split.alarm;
		node->every = split.bus < 0;
	}
	if (node->slash && (node->kind == NODE_SIGNAL || node->kind == NODE_CODE ||
	                    (node->type && node->type != PROPERTY_DIRECTORY)))
		node->kind = NODE_NONE;
}

/* The directories that devices have whose families hal/chips does not know. */
/* clang-format off */
static const char *const subdirectories[] = {
	"8bit", "910", "911", "B1-R1-A", "CO2", "DA5534", "DA5540", "DATANAB", "EDS0064",
	"EDS0065", "EDS0066", "EDS0067", "EDS0068", "EDS0070", "EDS0071", "EDS0072", "EDS0080",
	"EDS0082", "EDS0083", "EDS0085", "EDS0090", "HIH3600", "HIH4000", "HIH5030", "HTM1735",
	"LCD_H", "LCD_M", "LED", "MultiSensor", "S3-R1-A", "T8A", "TAI8570", "TH", "WS603",
	"about", "analog", "automation_engine", "aux", "barometer", "calibrate", "calibration",
	"cat9554", "comparator", "disconnect", "eeprom", "endcharge", "errata", "generic",
	"histogram", "hub", "iic", "lcd", "log", "main", "mission", "moisture", "multitemp",
	"output", "overtemp", "pages", "pwm1", "pwm2", "readonly", "relay", "sdcard", "serial",
	"set_password", "subkey0", "subkey1", "subkey2", "system", "timers", "typeB", "typeE",
	"typeJ", "typeK", "typeN", "typeR", "typeS", "typeT", "undertemp", "use_password",
	"user_registers", NULL,
};
/* clang-format on */

/* The directories that stand in no device. */
static const char *const virtual_subdirectories[] = {
	"bus",      "device",        "directory", "DS1WM",   "external",  "ha5",        "i2c",
	"internal", "K1WM",          "link",      "overall", "PBM",       "persistent", "primary",
	"read",     "search_errors", "secondary", "serial",  "simulated", "usb",        "write",
	NULL,
};

/* /structure/28: the entries are those that devices of the family have. */
static bool is_of_structure(const struct node *directory, const char *name, size_t len)
{
	static const char above[] = "/structure/";
	const char *code = directory->path + sizeof(above) - 1;
	const struct property *property;
	char path[NODE_PATH_MAX];
	int n;

	if (strncmp(directory->path, above, sizeof(above) - 1) != 0 || strlen(code) < 2)
		return false;
	n = snprintf(path, sizeof(path), "%s%s%.*s", code[2] ? code + 3 : "", code[2] ? "/" : "",
	             (int)len, name);
	if (n >= (int)sizeof(path))
		return false;
	property = family_property(family_of((uint8_t)strtoul(code, NULL, 16)), NULL, path,
	                           (size_t)n);
	return property ? property->type == PROPERTY_DIRECTORY
	                : node_is_in(subdirectories, name, len);
}

static bool is_subdirectory(const struct node *directory, const char *name, size_t len)
{
	struct node child;
	char path[NODE_PATH_MAX];
	int n = snprintf(path, sizeof(path), "%s/%.*s", directory->path, (int)len, name);

	if (n >= (int)sizeof(path))
		return false;
	node_parse(path, (size_t)n, &child);
	if (child.type)
		return child.type == PROPERTY_DIRECTORY;
	if (directory->has_device)
		return node_is_in(subdirectories, name, len);
	return is_of_structure(directory, name, len) ||
	       (strncmp(directory->path, "/structure", 10) != 0 &&
	        node_is_in(virtual_subdirectories, name, len));
}

bool node_is_directory(const struct node *directory, const char *name, size_t len)
{
	const char *path = directory->path + 1;

	if (directory->kind != NODE_TARGET)
		return false;
	if (directory->devices)
		return true;
	if (!directory->has_device && !strchr(path, '/'))
		return strcmp(path, "simultaneous") != 0;
	return is_subdirectory(directory, name, len);
}
