/* SPDX-License-Identifier: MIT */
/*
 * The configuration as owsd understood it, printed as a file that owsd would read again: the rows
 * of the table of keys, each with the value in force, also where it is the default.
 */
#include <stdlib.h>

#include "src/config/edit/print.h"
#include "src/config/edit/rio_write.h"
#include "src/config/read/options.h"

/* The key, indented by the depth of its block. */
static void put_key(FILE *out, const struct option_def *def)
{
	fprintf(out, "%*s%-*s ", def->place == PLACE_DRIVER ? 2 : 4, "", RIO_KEY_WIDTH - 1,
	        def->key);
}

static void put_text(FILE *out, const struct option_def *def, const char *text)
{
	char *quoted = rio_quote(text);

	put_key(out, def);
	fprintf(out, "%s\n", quoted ? quoted : "\"\"");
	free(quoted);
}

/* The strings of an alarm: what is not defined is not what is empty. */
static bool is_of_alarm(const struct option_def *def)
{
	return def >= &option_table[OPT_LATCH_ALARM] && def <= &option_table[OPT_RESET_LATCH];
}

void option_print(const struct option_def *def, const void *from, bool all, FILE *out)
{
	char room[VALUE_TEXT_MAX];

	if (!option_is_given(def, from)) {
		if (all && is_of_alarm(def))
			fprintf(out, "    # %-*s not defined\n", RIO_KEY_WIDTH - 3, def->key);
	} else if (def->quiet && option_is_preset(def, from)) {
		return;
	} else if (def->kind == OPTION_TEXT) {
		put_text(out, def, option_text(def, from, room));
	} else {
		put_key(out, def);
		fprintf(out, "%s\n", option_text(def, from, room));
	}
}

/* The rows of a place whose values the struct has. */
static void put_rows(FILE *out, enum option_place place, const void *from, bool all)
{
	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		if (option_table[i].place == place && option_table[i].store)
			option_print(&option_table[i], from, all, out);
}

static void put_block(FILE *out, const struct option_def *def, enum option_place place,
                      const void *from, bool all)
{
	fprintf(out, "  %s {\n", def->key);
	put_rows(out, place, from, all);
	fputs("  }\n", out);
}

static void put_targets(FILE *out, const struct option_def *def, const struct config *config)
{
	static const char *const relations[] = {
		[CONFIG_FIRST] = "",
		[CONFIG_COMMA] = ", ",
		[CONFIG_BAR] = " | ",
	};

	put_key(out, def);
	putc('"', out);
	for (unsigned i = 0; i < config->target_count; i++) {
		fputs(relations[config->targets[i].relation], out);
		for (const char *p = config->targets[i].text; *p; p++) {
			if (*p == '"' || *p == '\\')
				fputc('\\', out);
			fputc(*p, out);
		}
	}
	fputs("\"\n", out);
}

static void put_bus(FILE *out, const struct config_bus *bus)
{
	fprintf(out, "  %s {\n", option_table[OPT_BUS].key);
	put_text(out, &option_table[OPT_BUS_TARGET], bus->target);
	for (unsigned i = 0; i < bus->option_count; i++)
		put_text(out, &option_table[option_find(PLACE_BUS, bus->options[i].key)],
		         bus->options[i].text);
	fputs("  }\n", out);
}

/* Entry i of a list: the key stands before the first one, and after the last one the line ends. */
static void put_entry(FILE *out, const struct option_def *def, unsigned i, unsigned count,
                      const char *text)
{
	if (i == 0)
		put_key(out, def);
	fprintf(out, "%s%s%s", i ? ", " : "\"", text, i + 1 == count ? "\"\n" : "");
}

/* What no member holds as it is written. */
static void put_special(FILE *out, enum option option, const struct config *config)
{
	const struct option_def *def = &option_table[option];
	const struct config_serve *serve = &config->serve;
	char text[LISTEN_TEXT_MAX];

	switch (option) {
	case OPT_VERSION:
		put_key(out, def);
		fprintf(out, "%s\n", def->preset);
		break;
	case OPT_TARGET_NAME:
		put_targets(out, def, config);
		break;
	case OPT_LISTEN:
		for (unsigned i = 0; i < serve->address_count; i++) {
			listen_print(&serve->addresses[i], text);
			put_entry(out, def, i, serve->address_count, text);
		}
		break;
	case OPT_LISTEN_ALLOW:
		for (unsigned i = 0; i < serve->peer_count; i++) {
			listen_peers_print(&serve->peers[i], text);
			put_entry(out, def, i, serve->peer_count, text);
		}
		break;
	case OPT_CONTROL_ALLOW:
		for (unsigned i = 0; i < config->allow_count; i++)
			put_text(out, def, config->allows[i].text);
		break;
	case OPT_ITEM_COUNT:
		put_key(out, def);
		fprintf(out, "%u\n", config->item_count);
		break;
	case OPT_BUS:
		for (unsigned i = 0; i < config->bus_count; i++)
			put_bus(out, &config->buses[i]);
		break;
	case OPT_ITEM:
		for (unsigned i = 0; i < config->item_count; i++)
			config_print_item(&config->items[i], false, out);
		break;
	default:
		break;
	}
}

void config_print_item(const struct config_item *item, bool all, FILE *out)
{
	struct config_item shown = *item;

	if (!item->output)
		shown.read_back_ns = -1; /* outputs alone are read back */
	put_block(out, &option_table[OPT_ITEM], PLACE_ITEM, &shown, all);
}

void config_print(const struct config *config, FILE *out)
{
	fputs("OwsDrv {\n", out);
	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];

		if (def->place != PLACE_DRIVER)
			continue;
		if (def->store)
			option_print(def, config, false, out);
		else if (!def->inside)
			put_special(out, (enum option)i, config);
		else if (option_is_given(def, config))
			put_block(out, def, def->inside, (const char *)config + def->offset, false);
	}
	fputs("}\n", out);
}
