/* SPDX-License-Identifier: MIT */
/* Items of a configuration for devices that were found: their names, text and initial values. */
#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/find.h"
#include "src/config/edit/edit_block.h"
#include "src/config/edit/rio_write.h"
#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/shell.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/scan/scan_item.h"
#include "src/tool/scan/left_out.h"
#include "src/tool/scan/scan.h"

void scan_names_init(struct scan_names *names, size_t room)
{
	*names = (struct scan_names){.name = ctl_need(calloc(room + 1, sizeof(*names->name))),
	                             .room = (unsigned)room};
	if (!hcreate_r(2 * room + 1, &names->used))
		ctl_need(NULL);
	names->items = ctl_need(open_memstream(&names->text, &names->len));
}

size_t scan_items_most(const struct scan *scan)
{
	struct scan_property property;
	size_t most = 0;

	for (unsigned n = 0; n < scan->count; n++)
		for (unsigned i = 0; scan_property(&scan->device[n], i, &property); i++)
			most += property.type == OWS_BYTE ? SCAN_BITS : 1;
	return most;
}

void scan_names_free(struct scan_names *names)
{
	fclose(names->items);
	free(names->text);
	hdestroy_r(&names->used);
	free(names->name);
}

void scan_names_add(struct scan_names *names, const char *name)
{
	char *to = names->name[names->count];
	ENTRY *entered;

	if (names->count == names->room)
		return;
	memcpy(to, name, strnlen(name, SIGNAL_NAME_MAX)); /* the other bytes are 0 */
	names->count++;
	hsearch_r((ENTRY){.key = to}, ENTER, &entered, &names->used);
}

static bool is_free(struct scan_names *names, char *name)
{
	ENTRY *found;

	return !hsearch_r((ENTRY){.key = name}, FIND, &found, &names->used) &&
	       !signal_name_fault(name);
}

/* The last number given for the word: the search for a free number goes on from there. */
static unsigned *last_of(struct scan_names *names, const char *word)
{
	unsigned i = 0;

	while (i < SCAN_WORDS - 1 && names->word[i].word[0] &&
	       strcmp(names->word[i].word, word) != 0)
		i++;
	if (strcmp(names->word[i].word, word) != 0) {
		names->word[i].last = 0;
		snprintf(names->word[i].word, sizeof(names->word[i].word), "%s", word);
	}
	return &names->word[i].last;
}

/* A name of the alias, where a line stands for what no name may hold: "Bath_room". */
static bool choose_alias(struct scan_names *names, const struct scan_device *device,
                         const char *word, char *name, size_t room)
{
	char number[12] = "";

	if (!device->alias[0])
		return false;
	for (unsigned n = 2; n < 100; n++) {
		snprintf(name, room, "%s%s%s%s", device->alias, number, word ? "_" : "",
		         word ? word : "");
		for (char *p = name; (p = strpbrk(p, " \"#{}\\")); p++)
			*p = '_';
		if (is_free(names, name))
			return true;
		snprintf(number, sizeof(number), "_%u", n);
	}
	return false;
}

static bool has_several(const struct scan_device *device)
{
	struct scan_property property;
	unsigned n = 0;

	for (unsigned i = 0; scan_property(device, i, &property); i++)
		n += device->value[i].err != -ENOENT;
	return n > 1;
}

/*
 * The name of a signal: of the device's alias, with the property's word where it has several; else
 * the word with the first number that is free.
 */
static const char *choose_name(struct scan_names *names, const struct scan_device *device,
                               const struct scan_property *property, const char *element)
{
	bool several = *element || has_several(device);
	bool ends_in_digit = isdigit((unsigned char)property->word[strlen(property->word) - 1]);
	char name[SIGNAL_NAME_MAX + SCAN_ALIAS], word[48];

	snprintf(word, sizeof(word), "%s%s", property->word, element);
	if (!choose_alias(names, device, several ? word : NULL, name, sizeof(name))) {
		unsigned *last = last_of(names, property->word);

		do
			snprintf(name, sizeof(name), ends_in_digit ? "%s_%u" : "%s%u",
			         property->word, ++*last);
		while (!is_free(names, name));
	}
	scan_names_add(names, name);
	return names->name[names->count - 1];
}

/* element: what the name of a bit ends in where the device has an alias. */
static void make_item(struct scan_names *names, const struct scan_device *device,
                      const struct scan_property *property, const char *value, const char *element)
{
	const char *name = choose_name(names, device, property, element);
	bool named = strncmp(name, device->alias, strlen(device->alias)) == 0;
	char *described = named ? NULL : rio_quote(device->alias), *path = NULL;
	char rate[48] = "", init[160] = "";
	char whole[sizeof(device->path) + sizeof(property->name) + 3];

	if (property->per_factor)
		snprintf(rate, sizeof(rate), "  PerFactor               %u\n",
		         property->per_factor);
	if (property->output)
		snprintf(init, sizeof(init),
		         "  InitValue               \"%s\"\n"
		         "  Start                   last\n",
		         value);
	/* a server may call a coupler as it likes; other paths stay in one line */
	snprintf(whole, sizeof(whole), "\"%s/%s\"", device->path, property->name);
	if (strpbrk(device->path, "\"\\")) {
		whole[strlen(whole) - 1] = '\0';
		path = ctl_need(rio_quote(whole + 1));
	}
	fprintf(names->items,
	        "%s# %s%s%s%s%s\n"
	        "Item {\n"
	        "  Name                    \"%s\"\n"
	        "  Path                    %s\n"
	        "  Type                    \"%s\"\n"
	        "  IO                      \"%s\"\n"
	        "%s%s%s%s%s"
	        "}",
	        ftell(names->items) > 0 ? "\n" : "", device->type,
	        device->location[0] ? " on " : "", device->location,
	        device->simulated ? " (simulated)" : "",
	        property->output ? "; begins as it was found, later as it was last" : "", name,
	        path ? path : whole, value_type_name(property->type),
	        property->output ? "output" : "input",
	        described ? "  Description             " : "", described ? described : "",
	        described ? "\n" : "", rate, init);
	free(described);
	free(path);
}

/* Print what gets no item; it becomes a comment of the configuration, too. */
__attribute__((format(printf, 3, 4))) static void report(struct scan_names *names,
                                                         struct scan_choice choice, const char *fmt,
                                                         ...)
{
	char text[1024];
	va_list args;

	va_start(args, fmt);
	vsnprintf(text, sizeof(text), fmt, args);
	va_end(args);
	ctl_fail("%s", text);
	if (choice.noted)
		fprintf(names->items, "%s# %s", ftell(names->items) > 0 ? "\n" : "", text);
}

/* Does the property get an item? Reports the reason where the answer is a surprise. */
static bool gets_item(struct scan_names *names, const struct scan_device *device,
                      const struct scan_property *property, const struct scan_value *value,
                      struct scan_choice choice)
{
	int64_t number;

	if ((property->output && choice.inputs_only) || value->err == -ENOENT)
		return false;
	if (!property->output)
		return true;
	if (!value->err && !value_parse(property->type, value->text, &number))
		return true;
	report(names, choice, "left out: the output %s/%s, because it cannot be read: %s",
	       device->path, property->name, value->err ? error_text(value->err) : value->text);
	return false;
}

/* The bits of a property as PIO.BYTE, of which scan_property() gives "inputs" and "outputs". */
static bool make_bits(struct scan_names *names, const struct scan_device *device,
                      const struct scan_property *whole, const char *value)
{
	const char *dot = strchr(whole->name, '.');
	const struct property *array;
	char element[12];
	unsigned long bits = strtoul(value, NULL, 10);

	if (whole->type != OWS_BYTE || !dot)
		return false;
	array = family_property(family_of(device->family), NULL, whole->name,
	                        (size_t)(dot - whole->name));
	for (unsigned k = 0; array && k < array->array.count && k < SCAN_BITS; k++) {
		bool letters = array->array.index == INDEX_LETTERS;
		struct scan_property bit = {.type = OWS_BOOL, .output = whole->output};

		snprintf(element, sizeof(element), "%c", (char)((letters ? 'A' : '0') + (int)k));
		snprintf(bit.name, sizeof(bit.name), "%.*s.%s", (int)(dot - whole->name),
		         whole->name, element);
		snprintf(bit.word, sizeof(bit.word), "%.*s", (int)strcspn(whole->word, "s"),
		         whole->word);
		make_item(names, device, &bit, bits >> k & 1 ? "1" : "0", element);
	}
	return array != NULL;
}

bool scan_make_items(struct scan_names *names, const struct scan_device *device,
                     struct scan_choice choice)
{
	unsigned before = names->count;
	struct scan_property property;
	char dir[800], left_out[512], target[SHELL_WORD], path[SHELL_WORD];

	snprintf(dir, sizeof(dir), "owsctl %s%s%sdir %s lists what it has",
	         choice.target ? "-t " : "", choice.target ? shell_word(choice.target, target) : "",
	         choice.target ? " " : "", shell_word(device->path, path));
	for (unsigned i = 0; scan_property(device, i, &property); i++)
		if (gets_item(names, device, &property, &device->value[i], choice) &&
		    !(choice.bits && make_bits(names, device, &property, device->value[i].text)))
			make_item(names, device, &property, device->value[i].text, "");
	if (names->count == before) {
		report(names, choice, "no signal for %s (%s)%s%s; %s", device->path + 1,
		       device->type[0] ? device->type : "unknown",
		       device->err ? ", which does not say what it is: " : "",
		       device->err ? error_text(device->err) : "", dir);
		return false;
	}
	scan_left_out(device, left_out, sizeof(left_out));
	if (left_out[0])
		report(names, choice, "left out of %s (%s): %s; %s", device->path + 1, device->type,
		       left_out, dir);
	return true;
}

int scan_add_items(struct rio **rio, struct scan_names *names)
{
	if (fflush(names->items) || ferror(names->items))
		return -ENOMEM;
	return names->len ? rio_add(rio, edit_driver(*rio), names->text) : 0;
}

/* Why owsd would refuse the configuration; status CTL_DONE: owsd would accept it. */
struct refusal {
	const char *what;
	int status;
};

static void scan_item_refuse(void *ctx, bool is_error, const char *message)
{
	struct refusal *refusal = ctx;

	if (is_error && !refusal->status)
		refusal->status = ctl_fail("%s makes no configuration: %s", refusal->what, message);
}

int scan_check(const struct rio *rio, const char *what)
{
	struct refusal refusal = {.what = what};
	struct config_report report = {.line = scan_item_refuse, .ctx = &refusal};
	struct config *config;
	int err = config_parse("what was found", rio->text, rio->len, &report, &config);

	if (err == -ENOMEM)
		ctl_need(NULL);
	if (!err)
		config_free(config);
	return refusal.status;
}
