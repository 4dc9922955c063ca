/* SPDX-License-Identifier: MIT */
/*
 * The layout of major version 1, field by field: offset and size in bytes. Programs in other
 * languages are written against these numbers. A new field is added here too; no line is changed.
 */
#include "src/shm/layout.h"

#define AT(what, field, offset, size) \
	_Static_assert(offsetof(struct what, field) == (offset) && \
	                       sizeof(((struct what *)0)->field) == (size), \
	               #what "." #field)

AT(ows_sample, value, 0, 8);
AT(ows_sample, measured_ns, 8, 8);
AT(ows_sample, tried_ns, 16, 8);
AT(ows_sample, err, 24, 4);
AT(ows_sample, quality, 28, 1);
AT(ows_sample, detail, 29, 1);
AT(ows_sample, target, 30, 1);
AT(ows_sample, flags, 31, 1);
AT(ows_sample, count, 32, 4);
AT(ows_sample, applied, 36, 4);
AT(ows_sample, len, 40, 4);
AT(ows_sample, check, 44, 4);

AT(ows_attrs, transactions, 0, 8);
AT(ows_attrs, update_ns, 8, 8);
AT(ows_attrs, age_max_ns, 16, 8);
AT(ows_attrs, commanded, 24, 8);
AT(ows_attrs, per_base, 32, 4);
AT(ows_attrs, per_max, 36, 4);
AT(ows_attrs, pend_base, 40, 4);
AT(ows_attrs, pend_last, 44, 4);
AT(ows_attrs, pend_max, 48, 4);
AT(ows_attrs, alarms, 52, 4);
AT(ows_attrs, flags, 56, 4);
AT(ows_attrs, limit_state, 60, 1);
AT(ows_attrs, limit_condition, 61, 1);
AT(ows_attrs, check, 68, 4);

AT(ows_slot, sample, 0, 48);
AT(ows_slot, attrs, 48, 72);

AT(ows_record, seq, 0, 4);
AT(ows_record, text_off, 4, 4);
AT(ows_record, type, 8, 1);
AT(ows_record, flags, 9, 1);
AT(ows_record, text_cap, 10, 2);
AT(ows_record, slot, 16, 240);

AT(ows_info_entry, name_off, 0, 4);
AT(ows_info_entry, path_off, 4, 4);
AT(ows_info_entry, per_factor, 8, 4);
AT(ows_info_entry, line, 12, 4);
AT(ows_info_entry, stale_after_ns, 16, 8);
AT(ows_info_entry, init_value, 24, 8);
AT(ows_info_entry, safe_value, 32, 8);
AT(ows_info_entry, flags, 40, 4);

AT(ows_name_entry, name_off, 0, 4);
AT(ows_name_entry, record, 4, 4);

AT(ows_target_entry, name, 0, 104);
AT(ows_target_entry, state, 104, 4);
AT(ows_target_entry, reconnects, 108, 4);
AT(ows_target_entry, group, 112, 4);
AT(ows_target_entry, moves, 116, 4);

AT(ows_counter_entry, name, 0, 48);
AT(ows_counter_entry, target, 48, 4);
AT(ows_counter_entry, low, 56, 4);
AT(ows_counter_entry, high, 60, 4);

AT(ows_alarm_entry, seq, 0, 4);
AT(ows_alarm_entry, record, 4, 4);
AT(ows_alarm_entry, occurred_ns, 8, 8);
AT(ows_alarm_entry, before, 16, 8);
AT(ows_alarm_entry, after, 24, 8);
AT(ows_alarm_entry, kind, 32, 1);
AT(ows_alarm_entry, event, 33, 1);
AT(ows_alarm_entry, quality, 34, 1);
AT(ows_alarm_entry, flags, 35, 1);
AT(ows_alarm_entry, latch, 36, 20);
AT(ows_alarm_entry, number, 56, 4);
AT(ows_alarm_entry, check, 60, 4);

AT(ows_image_header, magic, 0, 4);
AT(ows_image_header, major, 4, 2);
AT(ows_image_header, minor, 6, 2);
AT(ows_image_header, size, 8, 4);
AT(ows_image_header, generation, 12, 4);
AT(ows_image_header, state, 16, 4);
AT(ows_image_header, pid, 20, 4);
AT(ows_image_header, start_id, 24, 4);
AT(ows_image_header, alarm_off, 28, 4);
AT(ows_image_header, start_ns, 32, 8);
AT(ows_image_header, start_wall_ns, 40, 8);
AT(ows_image_header, period_ns, 48, 8);
AT(ows_image_header, alarm_size, 56, 4);
AT(ows_image_header, alarm_count, 60, 4);
AT(ows_image_header, record_off, 64, 4);
AT(ows_image_header, record_size, 68, 4);
AT(ows_image_header, record_count, 72, 4);
AT(ows_image_header, info_off, 76, 4);
AT(ows_image_header, info_size, 80, 4);
AT(ows_image_header, name_off, 84, 4);
AT(ows_image_header, target_off, 88, 4);
AT(ows_image_header, target_size, 92, 4);
AT(ows_image_header, target_count, 96, 4);
AT(ows_image_header, counter_off, 100, 4);
AT(ows_image_header, counter_size, 104, 4);
AT(ows_image_header, counter_count, 108, 4);
AT(ows_image_header, pool_off, 112, 4);
AT(ows_image_header, pool_size, 116, 4);
AT(ows_image_header, text_off, 120, 4);
AT(ows_image_header, text_size, 124, 4);
AT(ows_image_header, news, 128, 4);
AT(ows_image_header, alarm_head, 132, 4);
AT(ows_image_header, served_off, 136, 4);

AT(ows_command_slot, value, 0, 8);
AT(ows_command_slot, stamp, 8, 4);
AT(ows_command_slot, client, 12, 4);
AT(ows_command_slot, read_enable, 16, 4);
AT(ows_command_slot, write_enable, 20, 4);
AT(ows_command_slot, one_shot, 24, 4);
AT(ows_command_slot, dgn_reset, 28, 4);

AT(ows_command_text, claim, 0, 4);
AT(ows_command_text, len, 4, 4);
AT(ows_command_text, check, 8, 4);

AT(ows_command_entry, name_off, 0, 4);
AT(ows_command_entry, path_off, 4, 4);
AT(ows_command_entry, type, 8, 4);
AT(ows_command_entry, text_off, 12, 4);

AT(ows_client, pid, 0, 4);
AT(ows_client, beat, 4, 4);
AT(ows_client, period_ms, 8, 4);

AT(ows_command_header, magic, 0, 4);
AT(ows_command_header, major, 4, 2);
AT(ows_command_header, minor, 6, 2);
AT(ows_command_header, size, 8, 4);
AT(ows_command_header, generation, 12, 4);
AT(ows_command_header, state, 16, 4);
AT(ows_command_header, pid, 20, 4);
AT(ows_command_header, start_id, 24, 4);
AT(ows_command_header, slot_off, 28, 4);
AT(ows_command_header, slot_size, 32, 4);
AT(ows_command_header, slot_count, 36, 4);
AT(ows_command_header, entry_off, 40, 4);
AT(ows_command_header, entry_size, 44, 4);
AT(ows_command_header, dirty_off, 48, 4);
AT(ows_command_header, dirty_words, 52, 4);
AT(ows_command_header, client_off, 56, 4);
AT(ows_command_header, client_size, 60, 4);
AT(ows_command_header, pool_off, 64, 4);
AT(ows_command_header, pool_size, 68, 4);
AT(ows_command_header, text_off, 72, 4);
AT(ows_command_header, text_size, 76, 4);
AT(ows_command_header, text_cap, 80, 4);
AT(ows_command_header, ack_off, 84, 4);
AT(ows_command_header, bell, 128, 4);
AT(ows_command_header, awake, 132, 4);

_Static_assert(OWS_LAYOUT_MAJOR == 1, "these are the numbers of major version 1");
_Static_assert(OWS_ALARMS == 256 && OWS_CLIENTS == 32, "published");
_Static_assert(OWS_IMAGE_MAGIC == 0x4953574f && OWS_COMMAND_MAGIC == 0x4353574f, "published");
_Static_assert(OWS_STATE_BUILDING == 0 && OWS_STATE_LIVE == 1 && OWS_STATE_RETIRED == 2 &&
                       OWS_STATE_STOPPED == 3,
               "published");
