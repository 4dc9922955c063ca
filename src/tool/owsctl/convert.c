/* SPDX-License-Identifier: MIT */
/*
 * owsctl convert: the items of a configuration for a program that asks owsd-modbus. --mbdrv: a file
 * of MbDrv, the Modbus driver of REXYGEN, as a TCP master. What its keys and types mean is known
 * from REXYGEN's public examples; no type stands here that they do not have.
 */
#include <errno.h>
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/edit/rio_write.h"
#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/tool/owsctl/modbus_map.h"
#include "src/tool/owsctl/verbs.h"

#define MB_COIL 0x01
#define MB_REGISTER 0x04
#define MB_FLOAT 0x40
#define MB_SIGNED 0x80
#define MB_WRITE 0x100
#define MB_READ 0x200
#define MB_DOUBLE 0x200000

#define PORT 502
#define ANY_UNIT 255

/* A form in which owsd-modbus serves a number. MbDrv has no int32 whose type is known. */
struct form {
	unsigned kind;
	enum layout_field field; /* in whose row it stands; LAYOUT_HEADER: it is a bit */
};

static struct form form_of(enum ows_type type)
{
	switch (type) {
	case OWS_BOOL:
		return (struct form){0, LAYOUT_HEADER};
	case OWS_BYTE:
	case OWS_SHORT:
		return (struct form){MB_REGISTER | MB_SIGNED, LAYOUT_SHORT};
	case OWS_FLOAT:
		return (struct form){MB_REGISTER | MB_FLOAT, LAYOUT_FLOAT};
	case OWS_LONG:
	case OWS_WORD:
	case OWS_DWORD:
	case OWS_DOUBLE:
	case OWS_LARGE:
	case OWS_STRING:
		break;
	}
	return (struct form){MB_REGISTER | MB_DOUBLE, LAYOUT_DOUBLE};
}

static void print_item(const char *name, unsigned address, unsigned type, unsigned count)
{
	char *quoted = ctl_need(rio_quote(name));

	printf("  Item {\n"
	       "    Name                    %s\n"
	       "    SlaveAdr                0\n"
	       "    RegisterAdr             %u\n"
	       "    Type                    0x%08X\n"
	       "    Count                   %u\n"
	       "  }\n",
	       quoted, address, type, count);
	free(quoted);
}

static void print_signal(const struct config_item *item, unsigned place)
{
	struct form form = form_of(item->type);
	bool bit = form.field == LAYOUT_HEADER;

	/* a bit that is written is a coil, one that is read a discrete input */
	print_item(item->name, bit ? place : layout_in_row(form.field, place),
	           form.kind | (item->output ? MB_WRITE : MB_READ) |
	                   (bit && item->output ? MB_COIL : 0),
	           layout_width(form.field));
}

/* Of the header: does owsd live, and is the first register of a number its upper one? */
static void print_header(void)
{
	print_item("owsd_live", LAYOUT_LIVE, MB_REGISTER | MB_READ, 1);
	print_item("owsd_heart", LAYOUT_HEART, MB_REGISTER | MB_READ, 1);
	print_item("owsd_order", LAYOUT_MAGIC, MB_REGISTER | MB_FLOAT | MB_READ, 2);
}

static void print_slave(const struct config_modbus *modbus)
{
	static const uint8_t any[sizeof(modbus->addresses->bytes)];
	struct listen_address at = {.bytes = {127, 0, 0, 1}, .port = PORT};
	char host[LISTEN_TEXT_MAX];

	if (modbus->address_count)
		at = modbus->addresses[0];
	if (!memcmp(at.bytes, any, sizeof(any)))
		ctl_tell("%s: it listens at each address: give IPaddress that of this machine",
		         modbus->listen);
	listen_print_host(&at, host);
	printf("Modbus {\n"
	       "  Name                    \"\"\n"
	       "  Timeout                 1000\n"
	       "  Flags                   8\n"
	       "  Gap                     10000\n"
	       "  Slave {\n"
	       "    Name                    \"owsd\"\n"
	       "    IPaddress               \"%s\"\n"
	       "    Subaddress              %u\n"
	       "    SlaveID                 0\n"
	       "    MaxRequest              16\n"
	       "    TCPport                 %u\n"
	       "  }\n",
	       host, modbus->unit ? modbus->unit : ANY_UNIT, at.port);
}

/* What owsd-modbus would not do with this file. */
static void warn(const struct config *config, unsigned outputs, unsigned strings)
{
	const struct config_modbus *modbus = &config->modbus;

	if (strings)
		ctl_tell("strings left out, which have no register: %u", strings);
	if (!modbus->given)
		ctl_tell("%s has no Modbus block: owsd-modbus needs one, as "
		         "Modbus { Listen \"127.0.0.1:502\" }",
		         config->file);
	if (outputs && !modbus->write)
		ctl_tell("Write is off: owsd-modbus refuses what the outputs get");
}

/* Places as owsd-modbus gives them to this file. */
static int print_mbdrv(const struct config *config, struct map *map)
{
	unsigned outputs = 0, strings = 0;

	print_slave(&config->modbus);
	for (unsigned i = 0; i < config->item_count; i++) {
		const struct config_item *item = &config->items[i];
		int place = item->type == OWS_STRING ? 0 : map_place(map, item->identity);

		if (place < 0)
			return ctl_fail("%s: %s", item->name,
			                place == -ENOSPC ? "no place is left" : strerror(-place));
		if (place)
			print_signal(item, (unsigned)place);
		strings += !place;
		outputs += place && item->output;
	}
	print_header();
	puts("}");
	warn(config, outputs, strings);
	return CTL_DONE;
}

int verb_convert(struct ctl *ctl, int argc, char **argv)
{
	struct config_report report = {.line = ctl_report};
	const char *directory = NULL;
	struct config *config;
	static struct map map;
	bool mbdrv = false;
	int c, err, status;

	while ((c = ctl_option(ctl, argc, argv, "d:m")) != -1)
		if (c == 'd')
			directory = optarg;
		else
			mbdrv = true;
	if (!mbdrv || argc - optind != 1)
		return ctl_usage(ctl, "it takes --mbdrv and a configuration of owsd");
	err = config_load(argv[optind], &report, &config);
	if (err)
		return err == -EINVAL ? CTL_USAGE : CTL_FAILED;
	status = modbus_map_given(ctl, config->modbus.map, directory, &map);
	if (!status)
		status = print_mbdrv(config, &map);
	map_free(&map);
	config_free(config);
	return status;
}
