/* SPDX-License-Identifier: MIT */
/* The requests of the alarm machine, state by state. */
#include <stdio.h>
#include <string.h>

#include "src/engine/alarm_arm.h"
#include "src/engine/alarm_ask.h"
#include "src/engine/alarm_item.h"
#include "src/engine/alarm_known.h"
#include "src/engine/scaling.h"
#include "src/engine/state.h"

static void ask_property(struct alarm_request *r, enum bus_op op, const char *before,
                         const struct alarm_item *i, const char *property, const char *data)
{
	r->op = op;
	r->row = i->row;
	snprintf(r->path, sizeof(r->path), "%s%s/%s", before, i->strings.path, property);
	r->len = (uint32_t)snprintf(r->data, sizeof(r->data), "%s", data);
}

static void ask_init(struct engine *e, struct alarm_machine *m, struct alarm_request *r)
{
	int64_t row = alarm_next_init(e, m);
	const struct signal *s = &e->table.signals[row];
	const struct config_item *item = s->item;

	r->op = BUS_WRITE;
	r->row = (uint32_t)row;
	snprintf(r->path, sizeof(r->path), "%s", item->path);
	if (item->type == OWS_STRING)
		r->len = (uint32_t)snprintf(r->data, sizeof(r->data), "%s", item->init_text);
	else
		r->len = signal_write_text(s, item->init_value, r->data);
}

/* The item whose SetAlarm is to be compared with the chip, if any is left. */
static bool ask_arm(struct alarm_machine *m, struct alarm_request *r, int64_t now_ns)
{
	const struct alarm_strings *s;

	if (m->arming < 0)
		m->arming = alarm_to_arm(m, now_ns);
	if (m->arming < 0)
		return false;
	s = &m->items[m->arming]->strings;
	ask_property(r, m->arm_writes ? BUS_WRITE : BUS_READ, "", m->items[m->arming], s->set,
	             m->arm_writes ? s->set_value : "");
	return true;
}

bool alarm_ask(struct alarm_machine *m, const struct lane *lane, struct alarm_request *r,
               int64_t now_ns)
{
	struct alarm_item *i = alarm_current(m);

	if (m->collecting >= 0) {
		i = m->items[m->collecting];
		ask_property(r, BUS_READ, "", i, i->strings.latch, "");
		return true;
	}
	if (m->proving) {
		ask_property(r, BUS_READ, "", i, i->strings.por, "");
		return true;
	}
	switch (m->state) {
	case INIT:
		m->position = -1;
		if (ask_arm(m, r, now_ns))
			return true;
		if (now_ns < m->list.next_ns)
			return false;
		if (!m->named)
			alarm_name_list(m, &lane->engine->table);
		r->op = BUS_DIR;
		r->row = TABLE_NO_ROW;
		memcpy(r->path, m->list_path, sizeof(m->list_path));
		return true;
	case ALARM_POR_READ:
		ask_property(r, BUS_READ, "", i, i->strings.por, "");
		return true;
	case ALARM_SET:
		ask_property(r, BUS_WRITE, "", i, i->strings.set, i->strings.set_value);
		return true;
	case ALARM_SET_WAIT:
		ask_init(lane->engine, m, r);
		return true;
	case ALARM_POR_RESET:
		ask_property(r, BUS_WRITE, "", i, i->strings.por, "0");
		return true;
	case ALARM_LATCH:
		ask_property(r, BUS_READ, "", i, i->strings.latch, "");
		return true;
	case ALARM_SENSED:
		ask_property(r, BUS_READ, "/alarm", i, i->strings.sensed, "");
		return true;
	case ALARM_LATCH_RESET:
		ask_property(r, BUS_WRITE, "/alarm", i, i->strings.reset, i->strings.reset_value);
		return true;
	case SENSED:
		ask_property(r, BUS_READ, "", i, i->strings.sensed, "");
		return true;
	case NOT_USED:
	case ALARM_DIR:
	case ALARM_PROCESS:
	case ALARM_POR_READ_WAIT:
	case ALARM_INIT_WRITE_WAIT:
	case ALARM_POR_RESET_WAIT:
	case ALARM_LATCH_WAIT:
	case ALARM_SENSED_WAIT:
	case ALARM_LATCH_RESET_WAIT:
	case SENSED_WAIT:
	case ALARM_BYPASS:
		break;
	}
	return false;
}
