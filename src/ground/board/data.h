/* SPDX-License-Identifier: MIT */
/*
 * The data of a board or of a HAT on it: the files of board/boards, a key and its value on each
 * line, `#` comments. Shell scripts read the same files with awk.
 */
#pragma once

#include <stddef.h>

#define BOARD_TEXT 120
#define BOARD_MODELS 4
#define BOARD_NOTES 2

/* Texts are "" where the file has no such key. */
struct board_data {
	char id[40];                          /* the file's name without ".board" */
	char name[BOARD_TEXT];                /* Name */
	char model[BOARD_MODELS][BOARD_TEXT]; /* Model: how /proc/device-tree/model begins */
	char hat_vendor[BOARD_TEXT];          /* HatVendor, HatProduct: the EEPROM's texts */
	char hat_product[BOARD_TEXT];
	int i2c;                    /* I2C: the header's adapter; -1: not given */
	unsigned khz;               /* KHz: the highest clock of the adapter; 0: not given */
	char pins[BOARD_TEXT];      /* Pins */
	char combine[BOARD_TEXT];   /* Combine: any, or one-read (one read, the last) */
	char gpio_chip[BOARD_TEXT]; /* GpioChip: its label */
	char enable[BOARD_TEXT];    /* Enable: the command that switches I2C on */
	char on_line[BOARD_TEXT];   /* OnLine, SpeedLine, WireLine: for config.txt */
	char speed_line[BOARD_TEXT];
	char wire_line[BOARD_TEXT];
	char chip[BOARD_TEXT]; /* Chip: address and type of its DS2482 */
	char note[BOARD_NOTES][BOARD_TEXT];
};

/* 0; -EINVAL or the error of reading, with file, line and reason in why. */
int board_data_read(const char *file, struct board_data *data, char *why, size_t why_size);

/*
 * Read all files *.board of a folder, sorted by id; at most max. Returns their number, or a
 * negative errno and why: with one wrong file all are refused.
 */
int board_data_list(const char *folder, struct board_data *data, unsigned max, char *why,
                    size_t why_size);

/* The board with the longest Model that the text begins with, or NULL. */
const struct board_data *board_data_model(const struct board_data *data, unsigned count,
                                          const char *model);
const struct board_data *board_data_hat(const struct board_data *data, unsigned count,
                                        const char *vendor, const char *product);
const struct board_data *board_data_id(const struct board_data *data, unsigned count,
                                       const char *id);
