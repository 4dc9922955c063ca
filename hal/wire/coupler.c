/* SPDX-License-Identifier: MIT */
/* The links in front of a wire with couplers: what they send before a transaction begins. */
#include <errno.h>
#include <string.h>

#include "hal/wire/coupler.h"

#define MATCH_ROM 0x55
#define STATUS 0x5a
#define LOOK 0x18 /* the status is not to be written */
#define SMART_ON_MAIN 0xcc
#define SMART_ON_AUX 0x33
#define ALL_LINES_OFF 0x66
#define STIMULUS 0xff
#define SILENT 0xff

/* The status of a branch is this, shifted by twice its number; events by its number. */
#define INACTIVE 0x01
#define LEVEL 0x02
#define EVENT_SHIFT 4

#define LOOKS 3
#define TRIES 3
#define FAULTY_RESETS 100 /* until one that answers wrong is tried again */

static struct link *under(const struct trunk *trunk)
{
	return trunk->link.wire;
}

static struct branch *outer_branch(const struct branch *branch)
{
	return branch->coupler->parent;
}

/* Is it the branch itself, or one that the branch is behind? */
static bool leads_to(const struct branch *which, const struct branch *branch)
{
	while (branch && branch != which)
		branch = outer_branch(branch);
	return branch == which;
}

static int coupler_enter(struct branch *branch);

/* Reset on the wire that the coupler is on, and what it is to do. -EHOSTDOWN: no chip is there. */
static int coupler_command(const struct coupler *coupler, const uint8_t *bytes, size_t n,
                           uint8_t *answer, size_t answer_n)
{
	struct link *link = under(coupler->trunk);
	uint8_t out[11] = {MATCH_ROM};
	const struct link_part part = {.reset = !coupler->parent,
	                               .out = out,
	                               .out_n = 9 + n,
	                               .in = answer,
	                               .in_n = answer_n};
	int present = coupler->parent ? coupler_enter(coupler->parent) : 1;

	if (present <= 0)
		return present ? present : -EHOSTDOWN;
	memcpy(out + 1, coupler->rom, 8);
	memcpy(out + 9, bytes, n);
	return link->ops->run(link, &part);
}

/* 1: a chip is there, 0: none is. -EHOSTDOWN: a coupler does not answer. */
static int coupler_enter(struct branch *branch)
{
	struct trunk *trunk = branch->coupler->trunk;
	uint8_t code = branch->number == COUPLER_MAIN ? SMART_ON_MAIN : SMART_ON_AUX;
	uint8_t answer[2] = {SILENT, SILENT};
	const uint8_t smart_on[] = {code, STIMULUS};

	if (!leads_to(branch, trunk->on))
		trunk->on = branch;
	int err = coupler_command(branch->coupler, smart_on, sizeof(smart_on), answer,
	                          sizeof(answer));
	if (err)
		return err;
	if (answer[0] == SILENT && answer[1] == SILENT)
		return -EHOSTDOWN;
	if (answer[1] != code || (answer[0] != 0x00 && answer[0] != 0xff))
		return -EBADMSG;
	return answer[0] == 0x00;
}

/* The status. A coupler that is silent looks like one in which every bit is set. */
static int look_at_status(struct coupler *coupler, uint8_t *info)
{
	static const uint8_t status[] = {STATUS, LOOK};
	uint8_t answer[2] = {SILENT, SILENT};
	int err = 0;

	for (int looks = 0; looks < LOOKS; looks++) {
		err = coupler_command(coupler, status, sizeof(status), answer, sizeof(answer));
		if (!err && answer[0] != answer[1])
			err = -EBADMSG;
		if (err || answer[0] != SILENT)
			break;
	}
	if (err)
		return err;
	*info = answer[0];
	/* silence is no event */
	if (answer[0] != SILENT) {
		struct coupler_seen *seen = coupler->seen;
		uint8_t flags = answer[0] >> EVENT_SHIFT & 3;

		seen->events |= flags;
		seen->news |= (uint8_t)(flags & ~seen->flags);
		seen->flags = flags;
	}
	return 0;
}

/* 1: it is off, 0: it does not answer. */
static int try_off(struct coupler *coupler)
{
	static const uint8_t off = ALL_LINES_OFF;
	uint8_t info, answer = SILENT;
	int err = look_at_status(coupler, &info);

	if (!err)
		err = coupler_command(coupler, &off, 1, &answer, 1);
	if (err)
		return err == -EHOSTDOWN ? 0 : err;
	if (answer == ALL_LINES_OFF)
		coupler->seen->flags = 0;
	return answer == ALL_LINES_OFF ? 1 : answer == SILENT ? 0 : -EBADMSG;
}

/*
 * Both branches off; one that never answers is gone, and what is behind it too. If it is behind
 * another, that one may be what does not answer. One that answers wrong may have a branch on: those
 * behind it hear what others are told, and answer to none but their own ids.
 */
static int switch_off(struct coupler *coupler)
{
	struct trunk *trunk = coupler->trunk;
	int done = 0;

	for (int try = 0; try < TRIES && (done == 0 || done == -EBADMSG); try++)
		done = try_off(coupler);
	if (done < 0 && done != -EBADMSG) {
		coupler->unsure = 1;
		return done;
	}
	coupler->unsure = done < 0 ? FAULTY_RESETS : !done && coupler->parent;
	if (trunk->on && trunk->on->coupler == coupler)
		trunk->on = coupler->parent;
	return 0;
}

/* Switch off what branch (NULL: the trunk) is not behind. */
static int leave_branches(struct trunk *trunk, const struct branch *branch)
{
	int err = 0;

	while (!err && trunk->on && !leads_to(trunk->on, branch))
		err = switch_off(trunk->on->coupler);
	return err;
}

int coupler_look(struct coupler *coupler)
{
	uint8_t info;
	int err = leave_branches(coupler->trunk, NULL);

	if (!err)
		err = look_at_status(coupler, &info);
	if (!err && !coupler->seen->news && coupler->seen->flags)
		err = switch_off(coupler);
	return err == -EHOSTDOWN ? -EBADMSG : err;
}

/* The couplers on this branch (NULL: on the trunk) that another master may have switched. */
static int make_sure(struct trunk *trunk, const struct branch *branch)
{
	struct coupler *coupler = trunk->first;
	int err = 0;

	for (; coupler && !err; coupler = coupler->next)
		if (coupler->unsure && coupler->parent == branch && !--coupler->unsure)
			err = switch_off(coupler);
	return err;
}

/* The branch and those that it is behind, from the outermost on: is one of them short? */
static int coupler_check(struct branch *branch)
{
	struct trunk *trunk = branch->coupler->trunk;
	uint8_t info = 0;

	while (!leads_to(branch, trunk->on)) {
		struct branch *next = branch;

		while (outer_branch(next) != trunk->on)
			next = outer_branch(next);
		int err = look_at_status(next->coupler, &info);
		if (err)
			return err;
		info >>= 2 * next->number;
		if ((info & INACTIVE) && !(info & LEVEL))
			return -ECOMM;
		if (next == branch)
			break;
		err = coupler_enter(next);
		if (err < 0)
			return err;
	}
	return 0;
}

int trunk_rest(struct trunk *trunk)
{
	return leave_branches(trunk, NULL);
}

static int trunk_run(struct link *link, const struct link_part *part)
{
	struct trunk *trunk = (struct trunk *)link;
	int err = part->reset ? leave_branches(trunk, NULL) : 0;

	if (!err && part->reset)
		err = make_sure(trunk, NULL);
	return err ? err : under(trunk)->ops->run(under(trunk), part);
}

static int branch_reset(struct branch *branch)
{
	struct trunk *trunk = branch->coupler->trunk;
	int err = leave_branches(trunk, branch);

	if (!err)
		err = coupler_check(branch);
	if (!err)
		err = make_sure(trunk, branch);
	if (!err)
		err = coupler_enter(branch);
	return err == -EHOSTDOWN ? -EBADMSG : err;
}

static int branch_run(struct link *link, const struct link_part *part)
{
	struct branch *branch = (struct branch *)link;
	struct link_part rest = *part;
	int present = part->reset ? branch_reset(branch) : 1;

	if (present <= 0)
		return present ? present : -EHOSTDOWN;
	rest.reset = false;
	return link->wire->ops->run(link->wire, &rest);
}

bool trunk_fits(const struct link *link)
{
	const struct link_ops *ops = link->ops;

	return !link->driver && !ops->search && !ops->verify && link->facts->splits;
}

/* It stands in front of the link of the wire. */
static void set_front(struct link *front, struct link *wire, const struct link_ops *ops)
{
	*front = *wire;
	front->ops = ops;
	front->wire = wire;
}

static void set_branch(const struct trunk *trunk, struct branch *branch)
{
	set_front(&branch->link, under(trunk), &trunk->branch_ops);
}

void trunk_set(struct trunk *trunk, struct link *link)
{
	trunk->ops = trunk->branch_ops = *link->ops;
	trunk->ops.run = trunk_run;
	trunk->branch_ops.run = branch_run;
	set_front(&trunk->link, link, &trunk->ops);
	for (struct coupler *coupler = trunk->first; coupler; coupler = coupler->next) {
		coupler->unsure = true;
		for (unsigned i = 0; i < COUPLER_BRANCHES; i++)
			set_branch(trunk, &coupler->branch[i]);
	}
}

void coupler_add(struct trunk *trunk, struct branch *parent, struct coupler *coupler,
                 const uint8_t rom[8], struct coupler_seen *seen)
{
	*coupler = (struct coupler){
		.trunk = trunk,
		.parent = parent,
		.next = trunk->first,
		.seen = seen,
		.unsure = true,
	};
	memcpy(coupler->rom, rom, sizeof(coupler->rom));
	for (unsigned i = 0; i < COUPLER_BRANCHES; i++) {
		coupler->branch[i].coupler = coupler;
		coupler->branch[i].number = (uint8_t)i;
		set_branch(trunk, &coupler->branch[i]);
	}
	trunk->first = coupler;
}

void coupler_remove(struct coupler *coupler)
{
	struct trunk *trunk = coupler->trunk;
	struct coupler **link = &trunk->first;

	for (unsigned i = 0; i < COUPLER_BRANCHES; i++)
		if (leads_to(&coupler->branch[i], trunk->on))
			trunk->on = coupler->parent;
	while (*link && *link != coupler)
		link = &(*link)->next;
	if (*link)
		*link = coupler->next;
}
