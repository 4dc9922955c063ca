/* SPDX-License-Identifier: MIT */
/*
 * A recording: the writer of history, the rows and the clock of one run of the recorder, and what
 * becomes of the news of a face.
 *
 * Room src/history/recorder: the program owsd-recorder: keeps what signals had, by rules.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "src/faces/kit/wall_clock.h"
#include "src/history/file/place.h"
#include "src/history/file/writer.h"
#include "src/history/recorder/series.h"

struct face;
struct face_event;

struct recording {
	char directory[HISTORY_PATH];
	struct config_recorder options; /* those that the writer was opened with */
	struct history_writer *writer;  /* NULL: no memory; nothing is recorded */
	struct wall_clock clock;
	struct series rows;
	int64_t boot;
	bool begun;        /* owsd was found in this run */
	int64_t lost_ns;   /* owsd is lost since then; 0: it is there */
	int64_t ticked_ns; /* the last look at intervals; 0: none yet */
	int disk_err;      /* as it was logged last */
	uint64_t dropped;  /* rows that were lost, as logged last */
	uint32_t files;    /* that were begun, as logged last */
};

/* The functions of the face's table; face->own is the recording. */
int recording_open(struct face *face);
void recording_changes(struct face *face, const int *signals, int n);
void recording_event(struct face *face, const struct face_event *event);
void recording_tick(struct face *face, int64_t now_ns);
void recording_close(struct face *face);
/* Writes what keeps it from recording. */
void recording_report(struct face *face, FILE *out);
