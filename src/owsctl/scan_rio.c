/* SPDX-License-Identifier: MIT */
#include "scan.h"

#include "../config/edit.h"
#include "../config/rio_write.h"
#include "../signal/attribute.h"
#include "../signal/value.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The names given so far, so that none is given twice. */
struct names {
	char (*name)[SIGNAL_NAME_MAX + 1];
	unsigned count;
};

static bool is_free(const struct names *names, const char *name)
{
	for (unsigned i = 0; i < names->count; i++)
		if (!strcmp(names->name[i], name))
			return false;
	return !signal_name_fault(name);
}

/*
 * The name of a signal: the device's alias, with the property's word where it has several; else
 * the word with the first number that is free.
 */
static const char *choose(struct names *names, const struct scan_device *device,
                          const struct scan_property *property)
{
	bool several = device->kind->property[1].name;
	char name[SIGNAL_NAME_MAX + SCAN_ALIAS];

	snprintf(name, sizeof(name), "%s%s%s", device->alias, several ? "_" : "",
	         several ? property->word : "");
	if (!device->alias[0] || strchr(name, '\\') || !is_free(names, name)) {
		unsigned n = 0;

		do
			snprintf(name, sizeof(name), "%s%u", property->word, ++n);
		while (!is_free(names, name));
	}
	memcpy(names->name[names->count], name, strlen(name) + 1);
	return names->name[names->count++];
}

static struct rio_node *driver_of(struct rio *rio)
{
	return rio_child(&rio->root, "OwsDrv");
}

static int add_item(struct rio **rio, struct names *names, const struct scan_device *device,
                    unsigned i)
{
	const struct scan_property *property = &device->kind->property[i];
	char text[512], rate[48] = "", init[128] = "";

	if (property->per_factor)
		snprintf(rate, sizeof(rate), "  PerFactor               %u\n", property->per_factor);
	if (property->output)
		snprintf(init, sizeof(init), "  InitValue               \"%s\"\n",
		         device->value[i].text);
	snprintf(text, sizeof(text),
	         "# %s%s%s%s%s\n"
	         "Item {\n"
	         "  Name                    \"%s\"\n"
	         "  Path                    \"%s/%s\"\n"
	         "  Type                    \"%s\"\n"
	         "  IO                      \"%s\"\n"
	         "%s%s"
	         "}",
	         device->type, device->location[0] ? " on " : "", device->location,
	         device->simulated ? " (simulated)" : "",
	         property->output ? "; its InitValue is what it was set to when found" : "",
	         choose(names, device, property), device->path, property->name,
	         value_type_name(property->type), property->output ? "output" : "input", rate, init);
	return rio_add(rio, driver_of(*rio), text);
}

/* Is it to be in the configuration? Says why not where that is a surprise. */
static bool wanted(const struct scan_device *device, unsigned i, bool inputs_only)
{
	const struct scan_property *property = &device->kind->property[i];
	const struct scan_value *value = &device->value[i];
	int64_t number;

	if (!property->name || (property->output && inputs_only) || value->err == -ENOENT)
		return false;
	if (!property->output)
		return true;
	if (!value->err && !value_parse(property->type, value->text, &number))
		return true;
	ctl_fail("left out: the output %s/%s, because it cannot be read: %s", device->path,
	         property->name, value->err ? error_text(value->err) : value->text);
	return false;
}

static int fill(struct rio **rio, struct names *names, const struct scan *scan, const char *target,
                bool inputs_only)
{
	char count[16], *quoted = rio_quote(target);
	int err = quoted ? rio_set(rio, driver_of(*rio), "TargetName", quoted) : -ENOMEM;

	rio_quote_free(quoted);
	for (unsigned d = 0; d < scan->count; d++)
		for (unsigned i = 0; scan->device[d].kind && i < SCAN_PROPERTIES && !err; i++)
			if (wanted(&scan->device[d], i, inputs_only))
				err = add_item(rio, names, &scan->device[d], i);
	snprintf(count, sizeof(count), "%u", names->count);
	return err ? err : rio_set(rio, driver_of(*rio), "ItemCount", count);
}

/* Why what was made for target is no configuration; status CTL_DONE: it is one. */
struct refusal {
	const char *target;
	int status;
};

static void refuse(void *ctx, bool is_error, const char *message)
{
	struct refusal *refusal = ctx;

	if (is_error && !refusal->status)
		refusal->status = ctl_fail("%s makes no configuration: %s", refusal->target, message);
}

/* Would owsd read what was made? Nothing else is printed, however targets are called. */
static int check(const struct rio *rio, const char *target)
{
	struct refusal refusal = {.target = target};
	struct config_report report = {.line = refuse, .ctx = &refusal};
	struct config *config;
	int err = config_parse("what was found", rio->text, rio->len, &report, &config);

	if (err == -ENOMEM)
		return ctl_fail("no memory");
	if (!err)
		config_free(config);
	return refusal.status;
}

int scan_rio(const struct scan *scan, const char *target, bool several, bool inputs_only)
{
	struct config_report silent = {0};
	struct names names = {.name = calloc((size_t)scan->count * SCAN_PROPERTIES + 1,
	                                     sizeof(*names.name))};
	struct rio *rio = NULL;
	int err = names.name ? 0 : -ENOMEM, status = CTL_DONE;

	/* several, where an owsd has them, stand as in TargetName; the name of one holds neither */
	if (!several && strpbrk(target, ",|")) {
		free(names.name);
		return ctl_fail("%s cannot be a TargetName: it holds \",\" or \"|\"", target);
	}
	if (!err)
		err = rio_parse("scan", edit_empty, strlen(edit_empty), &silent, &rio);
	if (!err)
		err = fill(&rio, &names, scan, target, inputs_only);
	if (err)
		status = ctl_fail("%s", err == -ENOMEM ? "no memory" : strerror(-err));
	else if (!names.count)
		status = ctl_fail("%s has no device that a configuration could be made for", target);
	else if ((status = check(rio, target)) == CTL_DONE)
		fwrite(rio->text, 1, rio->len, stdout);
	if (rio)
		rio_free(rio);
	free(names.name);
	return status;
}
