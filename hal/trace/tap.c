/* SPDX-License-Identifier: MIT */
/* A recording, or a replay: what a bus calls, and where its lines are. */
#include "hal/trace/tap.h"
#include "hal/trace/frames.h"
#include "hal/trace/i2c.h"
#include "hal/trace/links.h"

static void begin(struct trace *trace, struct tap tap)
{
	*trace = (struct trace){
		.tap = tap,
		.net = {.name = "net", .quotes = true},
		.i2c = {.name = "i2c"},
		.bus = {.name = "bus", .quotes = true},
		.peer = -1,
	};
}

void trace_record(struct trace *trace, FILE *file, bool i2c)
{
	begin(trace, (struct tap){.adapter = i2c ? trace_adapter_of : NULL,
	                          .link = i2c ? NULL : trace_link_of,
	                          .sent = trace_sent,
	                          .received = trace_received,
	                          .answered = trace_answered});
	trace->file = file;
	trace->left = TRACE_MOST / 2;
	fputs(TRACE_BEGIN, file);
}

int trace_replay(struct trace *trace, const char *name, char *why, size_t why_size)
{
	begin(trace, (struct tap){.adapter = trace_adapter_of,
	                          .link = trace_link_of,
	                          .connect = trace_connect,
	                          .sent = trace_sent,
	                          .received = trace_received,
	                          .answered = trace_answered});
	return trace_read(trace, name, why, why_size);
}

void trace_end(struct trace *trace)
{
	trace_frames_end(trace);
	trace_links_free(trace);
	trace_free(trace);
}
