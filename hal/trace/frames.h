/* SPDX-License-Identifier: MIT */
/* The exchanges of a connection and the answers of a bus, as the functions of a tap. */
#pragma once

#include "hal/trace/trace.h"

int trace_connect(struct tap *tap);
void trace_sent(struct tap *tap, const struct bus_env *env, const uint8_t *bytes, size_t n);
void trace_received(struct tap *tap, const struct bus_env *env, const uint8_t *bytes, size_t n);
void trace_answered(struct tap *tap, const struct bus_env *env, const struct bus_req *req,
                    const struct bus_answer *answer);
/* Write what has come of the last exchange, and free it. */
void trace_frames_end(struct trace *trace);
