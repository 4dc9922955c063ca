/* SPDX-License-Identifier: MIT */
/* Writes the entries of the image that change as a whole, so that a reader sees no half of one. */
#include <assert.h>
#include <string.h>

#include "src/memory/shm/entries.h"
#include "src/memory/shm/word.h"

/* The first word of an entry is its sequence word, the last its check word. */
#define WORDS_MAX (sizeof(struct ows_log_entry) / 4)

_Static_assert(sizeof(struct ows_journal_entry) <= 4 * WORDS_MAX &&
                       sizeof(struct ows_origin_entry) <= 4 * WORDS_MAX &&
                       sizeof(struct ows_controller_entry) <= 4 * WORDS_MAX &&
                       sizeof(struct ows_shelf_entry) <= 4 * WORDS_MAX &&
                       sizeof(struct ows_device_entry) <= 4 * WORDS_MAX,
               "the log's entry is the largest");

static void write_entry(void *to, const void *entry, size_t size)
{
	shm_word *seq = to;
	uint32_t n = __atomic_load_n(seq, __ATOMIC_RELAXED), words[WORDS_MAX];
	size_t last = size / 4 - 1;

	memcpy(words, entry, size);
	words[last] = ows_check(&words[1], last - 1);
	__atomic_store_n(seq, n + 1, __ATOMIC_RELAXED);
	word_fence(__ATOMIC_RELEASE);
	words_store(seq + 1, &words[1], last);
	__atomic_store_n(seq, n + 2, __ATOMIC_RELEASE);
}

void image_origin(struct image *image, uint32_t record, const struct ows_origin_entry *entry)
{
	assert(record < image->record_count);
	write_entry(&image->origins[record], entry, sizeof(*entry));
}

void image_controller(struct image *image, uint32_t place, const struct ows_controller_entry *entry)
{
	assert(place < OWS_CONTROLLERS);
	write_entry(&image->controllers[place], entry, sizeof(*entry));
}

void image_shelf(struct image *image, uint32_t place, const struct ows_shelf_entry *entry)
{
	assert(place < OWS_SHELVES && entry->record < image->record_count);
	write_entry(&image->shelves[place], entry, sizeof(*entry));
}

void image_device(struct image *image, uint32_t place, const struct ows_device_entry *entry)
{
	struct ows_device_entry whole = *entry;

	assert(place < image->device_count);
	whole.id_off = image->devices[place].id_off;
	whole.family_off = image->devices[place].family_off;
	write_entry(&image->devices[place], &whole, sizeof(whole));
}

/* The number of the newest line; 0: there is none. */
static uint32_t last_line(const struct image *image)
{
	uint32_t last = 0;

	for (uint32_t i = 0; i < image->log_lines; i++)
		if (image->log[i].number > last)
			last = image->log[i].number;
	return last;
}

void image_log(struct image *image, int64_t time_ns, uint32_t level, const char *text, size_t len)
{
	struct ows_log_entry entry = {.time_ns = time_ns, .level = level};

	if (!image->log_lines)
		return;
	entry.number = last_line(image) + 1;
	memcpy(entry.text, text, len < OWS_LINE ? len : OWS_LINE - 1);
	write_entry(&image->log[entry.number % image->log_lines], &entry, sizeof(entry));
}

void image_refused(struct image *image, int64_t time_ns, bool restart, const char *why, size_t len)
{
	struct ows_log_entry entry = {.time_ns = time_ns, .level = restart ? 4 : 3};

	if (!image->refused)
		return;
	entry.number = image->refused->number + 1;
	memcpy(entry.text, why, len < OWS_LINE ? len : OWS_LINE - 1);
	write_entry(image->refused, &entry, sizeof(entry));
}

void image_note(struct image *image, uint32_t target, int64_t time_ns, const char *text)
{
	struct ows_log_entry entry = {.time_ns = time_ns, .level = 5};

	assert(target < image->target_count);
	if (!image->notes)
		return;
	entry.number = image->notes[target].number + 1;
	memcpy(entry.text, text, strnlen(text, OWS_LINE - 1));
	write_entry(&image->notes[target], &entry, sizeof(entry));
}

void image_carry_log(struct image *image, const struct image *before)
{
	if (image->log_lines != before->log_lines)
		return;
	for (uint32_t i = 0; i < image->log_lines; i++)
		write_entry(&image->log[i], &before->log[i], sizeof(before->log[i]));
}

/* Enter an entry into a journal, which has its head in a word of the header. */
static uint32_t entries_enter(const struct image *image, struct ows_journal_entry *journal,
                              uint32_t *head, const struct ows_journal_entry *entry)
{
	struct ows_journal_entry whole = *entry;
	uint32_t number = word_get(head);

	assert(entry->record < image->record_count);
	whole.number = number;
	write_entry(&journal[number % OWS_JOURNAL], &whole, sizeof(whole));
	__atomic_store_n(head, number + 1, __ATOMIC_RELEASE);
	return number;
}

uint32_t image_alarm(struct image *image, const struct ows_journal_entry *entry)
{
	return entries_enter(image, image->alarms, &image->header->alarm_head, entry);
}

void image_alarm_after(struct image *image, uint32_t number, int64_t after)
{
	struct ows_journal_entry *entry = &image->alarms[number % OWS_JOURNAL], whole = *entry;

	if (word_get(&image->header->alarm_head) - 1 - number >= OWS_JOURNAL)
		return;
	whole.after = after;
	whole.flags |= OWS_JOURNAL_AFTER;
	write_entry(entry, &whole, sizeof(whole));
}

uint32_t image_command(struct image *image, const struct ows_journal_entry *entry)
{
	return entries_enter(image, image->commands, &image->header->command_head, entry);
}

static void carry_journal(struct ows_journal_entry *to, const struct ows_journal_entry *from,
                          uint32_t head, const uint32_t *records)
{
	for (uint32_t n = head > OWS_JOURNAL ? head - OWS_JOURNAL : 0; n != head; n++) {
		struct ows_journal_entry entry = from[n % OWS_JOURNAL];

		/* the place may have an entry of the new image, from before it took over */
		if (entry.number != n || !entry.record || records[entry.record - 1] == UINT32_MAX)
			entry = (struct ows_journal_entry){0};
		else
			entry.record = records[entry.record - 1] + 1;
		write_entry(&to[n % OWS_JOURNAL], &entry, sizeof(entry));
	}
}

void image_carry_journals(struct image *image, const struct image *before, const uint32_t *records)
{
	uint32_t alarms = word_get(&before->header->alarm_head);
	uint32_t commands = word_get(&before->header->command_head);

	carry_journal(image->alarms, before->alarms, alarms, records);
	carry_journal(image->commands, before->commands, commands, records);
	word_set(&image->header->alarm_head, alarms);
	word_set(&image->header->command_head, commands);
}
