/* SPDX-License-Identifier: MIT */
/* The trace of requests: a line in the log for each that a bus has answered, or has not in time. */
#include <stdio.h>

#include "src/daemon/engine/state.h"
#include "src/daemon/engine/trace.h"
#include "src/ground/signal/error.h"

#define TEXT_SHOWN 32 /* bytes of a value */
#define QUOTED_SIZE (TEXT_SHOWN + 40)

/* "21.5" without its padding; of a longer text the beginning, and how long it is. */
static void quote_data(const uint8_t *data, size_t len, char out[QUOTED_SIZE])
{
	size_t used = 0, shown;

	while (len && *data == ' ') {
		data++;
		len--;
	}
	shown = len > TEXT_SHOWN ? TEXT_SHOWN : len;
	out[used++] = '"';
	for (size_t i = 0; i < shown; i++)
		out[used++] = data[i] < 0x20 || data[i] > 0x7e ? '?' : (char)data[i];
	if (shown == len)
		snprintf(out + used, QUOTED_SIZE - used, "\"");
	else
		snprintf(out + used, QUOTED_SIZE - used, "...\" (%zu bytes)", len);
}

static void quote_result(const struct slot *slot, const struct bus_answer *answer,
                         char out[QUOTED_SIZE])
{
	unsigned entries = 0;

	switch ((enum bus_op)slot->req.op) {
	case BUS_READ:
		quote_data(slot->req.data, answer->len, out);
		break;
	case BUS_DIR:
		for (uint32_t i = 0; i < answer->len; i++)
			entries += slot->req.data[i] == '\n';
		snprintf(out, QUOTED_SIZE, "entries: %u", entries);
		break;
	case BUS_WRITE:
		snprintf(out, QUOTED_SIZE, "done");
		break;
	case BUS_PROBE:
		snprintf(out, QUOTED_SIZE, "present");
		break;
	}
}

/*
 * A quick target answers thousands of times a second: the log has to stay of use, and to keep up.
 */
static bool may_show(struct engine *e, bool failed)
{
	struct trace *trace = &e->trace;

	if (e->time.now_ns - trace->since_ns >= TRACE_WINDOW_NS) {
		if (trace->hidden)
			log_trace(e->log, "trace: %u more requests in a second", trace->hidden);
		*trace = (struct trace){.since_ns = e->time.now_ns};
	}
	if (trace->shown[failed] >= TRACE_PER_WINDOW) {
		trace->hidden++;
		return false;
	}
	trace->shown[failed]++;
	return true;
}

void trace_answer(const struct lane *lane, const struct slot *slot, const struct bus_answer *answer)
{
	static const char *const ops[] = {
		[BUS_READ] = "read",
		[BUS_WRITE] = "write",
		[BUS_DIR] = "dir",
		[BUS_PROBE] = "probe",
	};
	struct engine *e = lane->engine;
	char value[QUOTED_SIZE] = "", text[QUOTED_SIZE] = "";
	bool is_write = slot->req.op == BUS_WRITE;
	struct bus_req req = slot->req;

	if (!may_show(e, answer->err != 0))
		return;
	if (req.number) /* the bus may have the request still, and put the text into its data */
		req.data = (uint8_t *)text;
	if (is_write)
		quote_data(req.data, bus_write_text(&req), value);
	if (!answer->err)
		quote_result(slot, answer, text);
	log_trace(e->log, "trace: %s: %s %s%s%s%s: %s, %.1f ms%s", lane->port->target,
	          ops[slot->req.op], slot->req.fresh ? "/uncached" : "", slot->req.path,
	          is_write ? " " : "", value, answer->err ? error_text(answer->err) : text,
	          (double)(e->time.now_ns - slot->begun_ns) / 1e6,
	          slot->given_up ? " (too late)" : "");
}
