/* SPDX-License-Identifier: MIT */
/* A table written by python3, which reads lines of JSON from a pipe. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "src/faces/show/digits.h"
#include "src/faces/show/json.h"
#include "src/tool/owsctl/past.h"
#include "src/tool/owsctl/table_file.h"

/*
 * Nothing of the folder that owsctl runs in is imported. The table is written beside its name, and
 * gets it at the last line, "true": an end of the pipe before that is an error of owsctl's, which
 * it has told. A column has one type, so an integer that a double does not have exactly is a text.
 */
static const char script[] =
	"import sys\n"
	"if sys.path[:1] == ['']: del sys.path[0]\n"
	"import json, os\n"
	"kind, path = sys.argv[1:]\n"
	"part = f'{path}.{os.getpid()}.part'\n"
	"names = 'time', 'signal', 'value', 'text', 'quality'\n"
	"def exact(r):\n"
	"    if r[2] is None or float(r[2]) == r[2]: return r\n"
	"    return [*r[:2], None, str(r[2]), r[4]]\n"
	"def end(why): sys.exit(f'owsctl: {path}: {why}')\n"
	"class Sqlite:\n"
	"    def __init__(self):\n"
	"        self.db = sqlite3.connect(part)\n"
	"        self.db.execute('create table history (time integer not null, signal text not null, '\n"
	"                        'value real, text text, quality text not null)')\n"
	"    def put(self, rows):\n"
	"        self.db.executemany('insert into history values (?, ?, ?, ?, ?)', rows)\n"
	"    def close(self):\n"
	"        self.db.execute('create index history_signal on history (signal, time)')\n"
	"        self.db.commit()\n"
	"        self.db.close()\n"
	"class Parquet:\n"
	"    def __init__(self):\n"
	"        kinds = (pyarrow.timestamp('ns', 'UTC'), pyarrow.string(), pyarrow.float64(),\n"
	"                 pyarrow.string(), pyarrow.string())\n"
	"        self.schema = pyarrow.schema(list(zip(names, kinds)))\n"
	"        self.out = pyarrow.parquet.ParquetWriter(part, self.schema)\n"
	"    def put(self, rows):\n"
	"        columns = [pyarrow.array(c, f.type) for c, f in zip(zip(*rows), self.schema)]\n"
	"        self.out.write_table(pyarrow.Table.from_arrays(columns, schema=self.schema))\n"
	"    def close(self): self.out.close()\n"
	"try:\n"
	"    if kind == 'sqlite': import sqlite3\n"
	"    else: import pyarrow.parquet\n"
	"except ImportError as e: end(f'python3 needs {e.name or e} for --{kind}')\n"
	"if os.path.lexists(path): end('is there already')\n"
	"done = False\n"
	"try:\n"
	"    table, rows = Sqlite() if kind == 'sqlite' else Parquet(), []\n"
	"    for line in sys.stdin.buffer:\n"
	"        row = json.loads(line)\n"
	"        done = row is True\n"
	"        if not done: rows.append(exact(row))\n"
	"        if rows and (done or len(rows) == 65536):\n"
	"            table.put(rows)\n"
	"            rows = []\n"
	"    table.close()\n"
	"    if done: os.rename(part, path)\n"
	"except KeyboardInterrupt: done = False\n"
	"except Exception as e: end(e)\n"
	"finally:\n"
	"    for name in part, part + '-journal':\n"
	"        if os.path.lexists(name): os.unlink(name)\n"
	"sys.exit(not done)\n";

int table_file_begin(struct table_file *table, const char *kind, const char *path)
{
	const char *const command[] = {"python3", "-c", script, kind, path, NULL};
	char *words[sizeof(command) / sizeof(command[0])];
	posix_spawn_file_actions_t actions;
	int ends[2], err;

	if (pipe2(ends, O_CLOEXEC))
		return ctl_fail("%s", strerror(errno));
	/* that python3 has ended is an error of a write, and told by its status */
	signal(SIGPIPE, SIG_IGN);
	/* posix_spawnp() changes no word, though its type says that it might */
	memcpy(words, command, sizeof(words));
	err = posix_spawn_file_actions_init(&actions);
	if (!err) {
		err = posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
		if (!err)
			err = posix_spawnp(&table->pid, command[0], &actions, NULL, words, environ);
		posix_spawn_file_actions_destroy(&actions);
	}
	close(ends[0]);
	if (err) {
		close(ends[1]);
		return ctl_fail("python3, which --%s needs: %s", kind, strerror(err));
	}
	table->to = fdopen(ends[1], "w");
	if (table->to)
		return CTL_DONE;
	close(ends[1]);
	waitpid(table->pid, NULL, 0);
	return ctl_fail("no memory");
}

void table_file_put(struct table_file *table, const char *signal,
                    const struct ows_history_item *item)
{
	bool good = item->known && ows_good(item->quality), text = item->type == OWS_STRING;
	char number[VALUE_TEXT_MAX];
	struct json json;

	json_open(&json, table->to);
	json_array(&json, NULL);
	json_int(&json, NULL, item->time_ns);
	json_string(&json, NULL, signal);
	if (good && !text) {
		digits_print((enum ows_type)item->type, item->number, item->integer, -1, number);
		json_number(&json, NULL, number);
	} else {
		json_null(&json, NULL);
	}
	if (good && text)
		json_bytes(&json, NULL, item->text, item->len);
	else
		json_null(&json, NULL);
	json_string(&json, NULL, past_word(item));
	json_array_end(&json);
	json_end(&json);
}

bool table_file_broken(const struct table_file *table)
{
	return ferror(table->to);
}

int table_file_end(struct table_file *table, int status)
{
	int ended = 0;
	pid_t got;

	if (status == CTL_DONE)
		fputs("true\n", table->to);
	fclose(table->to);
	table->to = NULL;
	do
		got = waitpid(table->pid, &ended, 0);
	while (got < 0 && errno == EINTR);
	if (status != CTL_DONE)
		return status;
	if (got == table->pid && WIFSIGNALED(ended))
		return ctl_fail("python3 was ended by signal %d", WTERMSIG(ended));
	return got == table->pid && WIFEXITED(ended) && WEXITSTATUS(ended) == 0 ? CTL_DONE
	                                                                        : CTL_FAILED;
}
