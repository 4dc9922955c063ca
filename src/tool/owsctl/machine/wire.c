/* SPDX-License-Identifier: MIT */
/* owsctl doctor: the targets, and the signals that are not good, each fault once. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/bus/backends.h"
#include "hal/bus/bus.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/quality.h"
#include "src/ground/text/shell.h"
#include "src/tool/owsctl/machine/seen.h"
#include "src/tool/owsctl/machine/wire.h"

#define FAULTS 32
#define NAMES 3 /* of signals with the same fault that are named */

/* Signals with the same fault. */
struct fault {
	uint8_t quality;
	int err;
	unsigned count;
	char names[200];
};

/* Is a way to the wire up? */
static bool is_up(struct ows *h, uint32_t wire)
{
	struct ows_target way;

	for (int i = 0; ows_target(h, i, &way) == 0; i++)
		if (way.group == wire && way.state == 1)
			return true;
	return false;
}

/* The words of owsd on a target have the remedy. */
static void report_target(struct doctor *d, int index, const char *names, bool up)
{
	struct ows_log_line note;
	char span[WHEN_TEXT] = "";
	bool noted = ows_target_note(d->ows, index, &note) == 0;

	if (up && !noted) {
		report_add(&d->found, BOARD_FACT, "target %s: up", names);
		return;
	}
	if (noted)
		when_span(d->now_ns - note.time_ns, span);
	report_add(&d->found, BOARD_MISSING, "target %s is %s%s%s", names,
	           up ? "disturbed" : "down", noted ? ", for " : "", span);
	if (!up && seen_owserver_stopped(d, names))
		report_remedy(&d->found, "sudo systemctl start owserver");
	else if (noted)
		report_remedy(&d->found, SEEN_SAYS, "owsd", note.text);
	else
		report_remedy(&d->found, "%s", quality_remedy(OWS_Q_TARGET));
}

/*
 * A wire that no way reaches is one fault. Of its ways that counts which this board may have, or an
 * owserver that only has to be started.
 */
static void report_wire_down(struct doctor *d, uint32_t wire)
{
	struct ows_target way, best;
	int found = -1;

	for (int i = 0; ows_target(d->ows, i, &way) == 0; i++) {
		const struct bus_ops *ops = bus_backend(way.name, NULL);
		bool stopped = seen_owserver_stopped(d, way.name);

		if (way.group != wire || (found >= 0 && !stopped && !(ops && ops->board_advice)))
			continue;
		found = i;
		best = way;
		if (stopped)
			break;
	}
	if (found >= 0)
		report_target(d, found, best.name, false);
}

void check_targets(struct doctor *d)
{
	struct ows_target target;
	uint32_t wire = UINT32_MAX;

	for (int i = 0; d->alive && ows_target(d->ows, i, &target) == 0; i++) {
		if (is_up(d->ows, target.group)) {
			if (target.state == 1)
				report_target(d, i, target.name, true);
		} else if (target.group != wire) {
			report_wire_down(d, target.group);
		}
		wire = target.group;
	}
}

static void add_signal(struct fault *fault, const char *name)
{
	size_t used = strlen(fault->names);

	if (fault->count++ < NAMES)
		snprintf(fault->names + used, sizeof(fault->names) - used, "%s%.60s",
		         used ? ", " : "", name);
}

static unsigned collect(struct doctor *d, struct fault *faults)
{
	struct ows_target target;
	struct ows_value value;
	struct ows_info info;
	unsigned count = 0, k;

	for (int i = 0; i < ows_count(d->ows); i++) {
		if (ows_get_signal(d->ows, i, d->now_ns, &value) || ows_info(d->ows, i, &info) ||
		    ows_good(value.quality))
			continue;
		/* it was not set, or is read soon */
		if (value.quality == OWS_Q_INITIAL && !value.err)
			continue;
		/* the target is reported */
		if (value.quality == OWS_Q_TARGET &&
		    (ows_target(d->ows, value.target, &target) || !is_up(d->ows, target.group)))
			continue;
		for (k = 0; k < count; k++)
			if (faults[k].quality == value.quality && faults[k].err == value.err)
				break;
		if (k == FAULTS)
			continue;
		if (k == count)
			faults[count++] = (struct fault){.quality = value.quality,
			                                 .err = value.err};
		add_signal(&faults[k], info.name);
	}
	return count;
}

static void report_fault(struct doctor *d, const struct fault *fault)
{
	const char *remedy = error_remedy(fault->err);
	const char *word = ows_quality_text(fault->quality), *why = error_text(fault->err);
	bool usable = fault->quality >= 0x40, same = !fault->err || !strcmp(word, why);
	char more[32] = "", file[SHELL_WORD];

	if (fault->count > NAMES)
		snprintf(more, sizeof(more), " and %u more", fault->count - NAMES);
	report_add(&d->found, usable ? BOARD_NOTE : BOARD_MISSING, "%s%s: %s%s%s", fault->names,
	           more, word, same ? "" : ": ", same ? "" : why);
	report_remedy(&d->found, "%s", *remedy ? remedy : quality_remedy(fault->quality));
	/* it names the new chip of the same family */
	if (fault->err == -ENODEV && d->config)
		report_remedy(&d->found,
		              "%s; was the chip exchanged? sudo owsctl -n %s scan --rio --merge %s "
		              ">/dev/null",
		              remedy, d->instance, shell_word(d->file, file));
}

/* A short, or a bridge that is dead, stands before what follows from it. */
static bool is_of_wire(const struct fault *fault)
{
	return fault->quality == OWS_Q_SHORT || fault->quality == OWS_Q_TARGET;
}

void check_wire(struct doctor *d)
{
	struct fault faults[FAULTS];
	unsigned count = d->alive ? collect(d, faults) : 0;

	for (int turn = 0; turn < 2; turn++)
		for (unsigned i = 0; i < count; i++)
			if (is_of_wire(&faults[i]) == (turn == 0))
				report_fault(d, &faults[i]);
}
