/* SPDX-License-Identifier: MIT */
/*
 * The layout of the command segment NAME.command, of major version 1: consumers write
 * it; owsd believes nothing it finds there.
 */
#ifndef SHM_OLD_COMMANDS_H
#define SHM_OLD_COMMANDS_H
/* clang-format off */

#include "src/shm/layout.h"

#define OLD_LAYOUT_MAJOR 1
#define OLD_LAYOUT_MINOR 2
#define OLD_COMMAND_MAGIC 0x4353574fu /* "OWSC" */

/* A consumer's commands for one record; slot i belongs to record i. Slot 0: driver _DGNRESET. */
struct old_command_slot { /* 32 bytes */
	uint64_t value;    /* as ows_sample.value */
	uint32_t stamp;    /* counts commands (fetch_add after value is stored); 0: never set */
	uint32_t client;   /* index + 1 in the client table of who set it last; 0: nobody who beats;
	                      OLD_CLIENT_SAFE: owsd put it to SafeValue */
	uint32_t read_enable;  /* 0 not commanded, 1 off, 2 on */
	uint32_t write_enable; /* likewise */
	uint32_t one_shot;     /* counts edges of _WriteOneShot */
	uint32_t dgn_reset;    /* counts edges of _DGNRESET */
};

#define OLD_CLIENT_SAFE 0xffffffffu

/* Strings: the claim is taken by compare-and-swap from 0 to the writer's pid. */
struct old_command_text { /* 16 bytes, then text_cap bytes */
	uint32_t claim;
	uint32_t len;
	uint32_t check; /* ows_check_bytes() */
	uint32_t spare;
};

/* What a slot meant, so that values are carried over a restart by name, type and path. */
struct old_command_entry { /* 16 bytes */
	uint32_t name_off;
	uint32_t path_off;
	uint32_t type;
	uint32_t text_off; /* strings: offset of struct old_command_text, else 0 */
};

#define OLD_CLIENTS 32
struct old_client { /* 32 bytes */
	uint32_t pid;       /* 0: free; taken by compare-and-swap */
	uint32_t beat;      /* counts */
	uint32_t period_ms; /* promised longest time between two beats */
	uint32_t spare[5];
};

struct old_command_header { /* 256 bytes */
	uint32_t magic;
	uint16_t major, minor;
	uint32_t size;
	uint32_t generation;
	uint32_t state;    /* enum ows_state, written by owsd */
	int32_t pid;
	uint32_t start_id;
	uint32_t slot_off, slot_size, slot_count;
	uint32_t entry_off, entry_size;
	uint32_t dirty_off, dirty_words; /* one bit for each slot, set by consumers */
	uint32_t client_off, client_size;

	uint32_t pool_off, pool_size;
	uint32_t text_off, text_size, text_cap;
	uint32_t ack_off;  /* one word for each slot: counts acknowledgements; 0 in 1.0 */
	uint32_t spare1[10];

	uint32_t bell;     /* the engine's futex word: fetch_add 1, wake one */
	uint32_t awake;    /* not 0: the engine works and looks before it sleeps; no wake needed */
	uint32_t spare2[14];

	uint32_t spare3[16];
};

OWS_STATIC_ASSERT(sizeof(struct old_command_slot) == 32);
OWS_STATIC_ASSERT(sizeof(struct old_command_text) == 16);
OWS_STATIC_ASSERT(sizeof(struct old_command_entry) == 16);
OWS_STATIC_ASSERT(sizeof(struct old_client) == 32);
OWS_STATIC_ASSERT(sizeof(struct old_command_header) == 256);
OWS_STATIC_ASSERT(offsetof(struct old_command_header, bell) == 128);

#endif
