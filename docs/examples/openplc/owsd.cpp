// SPDX-License-Identifier: MIT
//
// Signals of owsd as located variables of a PLC program: a hardware layer for the runtime of OpenPLC
// 3, and with OPENPLC_V4 a native plug-in for that of OpenPLC 4. docs/openplc.md says how to put it
// in. It is compiled against OpenPLC's own header, ladder.h (under the GPL; this file alone is not)
// or plugin_types.h.
//
// What is what stands in a map: the file that plugins.conf names for a plug-in, else the one of
// OWSD_OPENPLC_MAP, else /etc/owsd/openplc.map.
#include <ows.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <future>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#ifdef OPENPLC_V4
#include "plugin_types.h"
#else
#include "ladder.h"
#endif

namespace {

enum class Kind { boolean, good, usint, sint, integer, uinteger, dint, udint, real, lint, lreal };

struct KindName {
	const char *name;
	Kind kind;
	char size; // of the variable: %IW0 has the size W
};
const KindName kinds[] = {
	// The first of a size is what a variable has without a type
	{ "bool", Kind::boolean, 'X' },  { "quality", Kind::good, 'X' },
	{ "usint", Kind::usint, 'B' },   { "sint", Kind::sint, 'B' },
	{ "int", Kind::integer, 'W' },   { "uint", Kind::uinteger, 'W' },
	{ "dint", Kind::dint, 'D' },     { "udint", Kind::udint, 'D' },
	{ "real", Kind::real, 'D' },     { "lint", Kind::lint, 'L' },
	{ "lreal", Kind::lreal, 'L' },
};

struct Signal {
	std::string name;
	int id = -ENOENT;
	bool good = false;
	ows_value value = ows_value();
};

// One line of the map
struct Variable {
	char area = 'I', size = 'X';
	unsigned index = 0, bit = 0;
	size_t signal = 0;
	Kind kind = Kind::boolean;
	double scale = 1, otherwise = 0;
	bool has_otherwise = false;
	int told = 0; // the error that the log has already

	std::string text() const
	{
		std::string name = std::string("%") + area + size + std::to_string(index);

		return size == 'X' ? name + "." + std::to_string(bit) : name;
	}
};

// --- The runtime ---------------------------------------------------------------------------------

// A cell holds the bits of its variable, whatever that is. Both runtimes call their cells the same.
#ifdef OPENPLC_V4

#define CELLS(kind) runtime.kind
const bool has_long_outputs = true;
plugin_runtime_args_t runtime; // a copy: the runtime frees its own

unsigned cells()
{
	return (unsigned)runtime.buffer_size;
}

unsigned long long cycle_ns()
{
	return runtime.base_tick_ns;
}

void say(const std::string &text)
{
	runtime.log_info("owsd: %s", text.c_str());
}

// In the journal, without a lock: the runtime takes it at the start of the next cycle
void store(const Variable &v, uint64_t bits)
{
	enum { BOOL_INPUT = 0, BYTE_INPUT = 3, INT_INPUT = 5, DINT_INPUT = 8, LINT_INPUT = 11 };
	const int i = (int)v.index;

	switch (v.size) {
	case 'X':
		runtime.journal_write_bool(BOOL_INPUT, i, (int)v.bit, (int)bits);
		break;
	case 'B':
		runtime.journal_write_byte(BYTE_INPUT, i, (uint8_t)bits);
		break;
	case 'W':
		runtime.journal_write_int(INT_INPUT, i, (uint16_t)bits);
		break;
	case 'D':
		runtime.journal_write_dint(DINT_INPUT, i, (uint32_t)bits);
		break;
	default:
		runtime.journal_write_lint(LINT_INPUT, i, bits);
	}
}

#else

#define CELLS(kind) kind
const bool has_long_outputs = false; // its generator binds %QL to its inputs

unsigned cells()
{
	return BUFFER_SIZE;
}

unsigned long long cycle_ns()
{
	return common_ticktime__;
}

void say(const std::string &text)
{
	std::vector<char> line;

	for (char c : "owsd: " + text + "\n")
		line.push_back(c);
	line.push_back('\0');
	openplc_log(line.data());
}

void store(const Variable &v, uint64_t bits)
{
	const unsigned i = v.index;

	switch (v.size) {
	case 'X':
		*bool_input[i][v.bit] = bits != 0;
		break;
	case 'B':
		*byte_input[i] = (IEC_BYTE)bits;
		break;
	case 'W':
		*int_input[i] = (IEC_UINT)bits;
		break;
	case 'D':
		*dint_input[i] = (IEC_UDINT)bits;
		break;
	default:
		*lint_input[i] = (IEC_ULINT)bits;
	}
}

#endif

// OpenPLC 3 has no cell for a variable that the program does not have
bool present(const Variable &v)
{
	const unsigned i = v.index;
	const bool in = v.area == 'I';

	switch (v.size) {
	case 'X':
		return (in ? CELLS(bool_input) : CELLS(bool_output))[i][v.bit] != nullptr;
	case 'B':
		return (in ? CELLS(byte_input) : CELLS(byte_output))[i] != nullptr;
	case 'W':
		return (in ? CELLS(int_input) : CELLS(int_output))[i] != nullptr;
	case 'D':
		return (in ? CELLS(dint_input) : CELLS(dint_output))[i] != nullptr;
	}
	return (in ? CELLS(lint_input) : CELLS(lint_output))[i] != nullptr;
}

uint64_t load(const Variable &v)
{
	const unsigned i = v.index;

	switch (v.size) {
	case 'X':
		return *CELLS(bool_output)[i][v.bit] != 0;
	case 'B':
		return *CELLS(byte_output)[i];
	case 'W':
		return *CELLS(int_output)[i];
	case 'D':
		return *CELLS(dint_output)[i];
	}
	return *CELLS(lint_output)[i];
}

// --- The map -----------------------------------------------------------------------------------

class Map {
public:
	std::string instance = "OWS";
	std::vector<Variable> variables;
	std::vector<Signal> signals;

	void read(const std::string &path)
	{
		std::ifstream file(path);
		std::string line;
		unsigned number = 0;

		if (!file)
			throw std::runtime_error(path + ": " + std::strerror(errno));
		while (std::getline(file, line)) {
			number++;
			try {
				take(line.substr(0, line.find('#')));
			} catch (const std::exception &e) {
				throw std::runtime_error(path + ":" + std::to_string(number) + ": " + e.what());
			}
		}
	}

private:
	void take(const std::string &line)
	{
		std::istringstream words(line);
		std::string location, name, word;
		Variable v;

		if (!(words >> location))
			return;
		if (!(words >> name))
			throw std::runtime_error("'" + location + "' of which signal?");
		if (location == "instance") {
			instance = name;
			return;
		}
		locate(location, v);
		for (const KindName &k : kinds) {
			if (k.size == v.size) {
				v.kind = k.kind;
				break;
			}
		}
		while (words >> word)
			option(word, words, v);
		if (v.kind == Kind::good && v.area == 'Q')
			throw std::runtime_error("a quality is an input: %IX");
		for (const Variable &other : variables) {
			if (other.text() == v.text())
				throw std::runtime_error(v.text() + " is already there");
		}
		v.signal = signal(name);
		variables.push_back(v);
	}

	static void locate(const std::string &text, Variable &v)
	{
		char tail = 0;
		int n = std::sscanf(text.c_str(), "%%%c%c%u.%u%c", &v.area, &v.size, &v.index, &v.bit, &tail);

		if (n < 3 || (v.area != 'I' && v.area != 'Q') || !std::strchr("XBWDL", v.size) ||
		    n != (v.size == 'X' ? 4 : 3) || std::isdigit((unsigned char)text[3]) == 0)
			throw std::runtime_error("'" + text + "' is no variable such as %IX0.0 %IW3 %QD1");
		if (v.index >= cells() || v.bit > 7)
			throw std::runtime_error("'" + text + "' is beyond OpenPLC's " +
			                         std::to_string(cells()) + " variables of a kind");
		if (!has_long_outputs && v.area == 'Q' && v.size == 'L')
			throw std::runtime_error("OpenPLC does not bind %QL to its outputs; take %QD or %QW");
	}

	static void option(const std::string &word, std::istringstream &words, Variable &v)
	{
		if (word == "scale") {
			if (!(words >> v.scale) || v.scale == 0 || !std::isfinite(v.scale))
				throw std::runtime_error("scale wants a number that is not 0");
			return;
		}
		if (word == "else") {
			if (!(words >> v.otherwise) || v.area == 'Q')
				throw std::runtime_error("else wants a number, and stands with inputs");
			v.has_otherwise = true;
			return;
		}
		for (const KindName &k : kinds) {
			if (word == k.name && k.size == v.size) {
				v.kind = k.kind;
				return;
			}
		}
		throw std::runtime_error("'" + word + "' is neither scale, else, nor a type of %" + v.area +
		                         v.size);
	}

	size_t signal(const std::string &name)
	{
		for (size_t i = 0; i < signals.size(); i++) {
			if (signals[i].name == name)
				return i;
		}
		signals.emplace_back();
		signals.back().name = name;
		return signals.size() - 1;
	}
};

// --- The variables -------------------------------------------------------------------------------

// The bits of a whole number, if the type holds it
template <typename T> bool whole(double value, uint64_t &bits)
{
	double number = std::round(value);

	// 2^63 and more: as doubles the limits themselves are not exact
	if (!(number >= (double)std::numeric_limits<T>::min() &&
	      number < (double)std::numeric_limits<T>::max() + 1.0))
		return false;
	bits = (uint64_t)(T)number;
	return true;
}

template <typename T, typename Bits> bool real(double value, uint64_t &bits)
{
	T number = (T)value;
	Bits same;

	static_assert(sizeof(number) == sizeof(same), "the bits of the one are those of the other");
	std::memcpy(&same, &number, sizeof(same));
	bits = same;
	return std::isfinite(number);
}

template <typename T, typename Bits> double real_of(uint64_t bits)
{
	Bits same = (Bits)bits;
	T number;

	std::memcpy(&number, &same, sizeof(number));
	return (double)number;
}

// False: the variable cannot hold it
bool bits_of(Kind kind, double value, uint64_t &bits)
{
	switch (kind) {
	case Kind::boolean:
	case Kind::good:
		bits = value != 0;
		return true;
	case Kind::usint:
		return whole<uint8_t>(value, bits);
	case Kind::sint:
		return whole<int8_t>(value, bits);
	case Kind::integer:
		return whole<int16_t>(value, bits);
	case Kind::uinteger:
		return whole<uint16_t>(value, bits);
	case Kind::dint:
		return whole<int32_t>(value, bits);
	case Kind::udint:
		return whole<uint32_t>(value, bits);
	case Kind::real:
		return real<float, uint32_t>(value, bits);
	case Kind::lint:
		return whole<int64_t>(value, bits);
	case Kind::lreal:
		return real<double, uint64_t>(value, bits);
	}
	return false;
}

// False: the variable keeps what it has
bool put(const Variable &v, double value)
{
	uint64_t bits = 0;

	if (!bits_of(v.kind, value, bits))
		return false;
	store(v, bits);
	return true;
}

double take(const Variable &v)
{
	const uint64_t bits = load(v);

	switch (v.kind) {
	case Kind::sint:
		return (int8_t)bits;
	case Kind::integer:
		return (int16_t)bits;
	case Kind::dint:
		return (int32_t)bits;
	case Kind::lint:
		return (double)(int64_t)bits;
	case Kind::real:
		return real_of<float, uint32_t>(bits);
	case Kind::lreal:
		return real_of<double, uint64_t>(bits);
	case Kind::boolean:
	case Kind::good:
	case Kind::usint:
	case Kind::uinteger:
	case Kind::udint:
		break;
	}
	return (double)bits;
}

// --- The layer -----------------------------------------------------------------------------------

class Layer {
public:
	// given: "" for the map of the environment
	void start(const std::string &given)
	{
		const char *path = std::getenv("OWSD_OPENPLC_MAP");

		map_ = Map();
		outputs_ = false;
		map_.read(!given.empty() ? given : path ? path : "/etc/owsd/openplc.map");
		for (const Variable &v : map_.variables)
			outputs_ = outputs_ || v.area == 'Q';
		say(std::to_string(map_.variables.size()) + " variables of instance " + map_.instance);
	}

	// A signal is read once, however many variables it has
	void in()
	{
		int64_t now = ows_now();

		look_for(now);
		for (Signal &s : map_.signals) {
			int err = handle_ ? ows_get(handle_, s.id, now, &s.value) : -ENOENT;

			keep_up(err);
			s.good = (err == 0 || err == -ESTALE) && ows_good(s.value.quality);
		}
		for (Variable &v : map_.variables) {
			if (v.area == 'I' && v.kind != Kind::good && present(v))
				show(v, map_.signals[v.signal]);
		}
		for (const Variable &v : map_.variables) {
			if (v.kind == Kind::good && present(v))
				put(v, map_.signals[v.signal].good);
		}
	}

	void out()
	{
		if (!handle_)
			return;
		for (Variable &v : map_.variables) {
			if (v.area == 'Q' && present(v))
				set(v, take(v) / v.scale);
		}
		// Outputs go to their SafeValue where this stops
		if (outputs_)
			keep_up(ows_beat(handle_, beat_ms()));
	}

	void stop()
	{
		if (opening_.valid())
			handle_ = opening_.get().handle;
		if (!handle_)
			return;
		for (Variable &v : map_.variables) {
			if (v.area == 'Q' && present(v))
				set(v, 0);
		}
		ows_close(handle_);
		handle_ = nullptr;
	}

private:
	struct Opened {
		ows *handle;
		int err;
	};

	static Opened open(const std::string &instance, ows_mode mode)
	{
		Opened opened = {nullptr, 0};

		opened.err = ows_open(instance.c_str(), mode, &opened.handle);
		return opened;
	}

	// ows_open() may wait 2 s for an owsd that hangs: the PLC's cycle does not
	bool has_opened(int64_t now)
	{
		Opened opened;

		if (!opening_.valid()) {
			if (now < next_try_)
				return false;
			next_try_ = now + 1000000000;
			opening_ = std::async(std::launch::async, open, map_.instance,
			                      outputs_ ? OWS_CONTROL : OWS_READ);
		}
		if (opening_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
			return false;
		opened = opening_.get();
		handle_ = opened.handle;
		if (opened.err && opened.err != told_)
			say("instance " + map_.instance + ": " + std::strerror(-opened.err) +
			    "; trying again");
		told_ = opened.err;
		return opened.err == 0;
	}

	void look_for(int64_t now)
	{
		if (stale_ && handle_ && ows_reopen(handle_) == 0)
			find();
		stale_ = false;
		if (handle_ || !has_opened(now))
			return;
		say("instance " + map_.instance + " is there");
		find();
	}

	// Ids stay right over a restart or reload of owsd
	void find()
	{
		for (Signal &s : map_.signals) {
			if (s.id < 0)
				s.id = ows_find(handle_, s.name.c_str());
			if (s.id < 0)
				say("no signal " + s.name + " in instance " + map_.instance);
		}
	}

	// After a restart or reload of owsd; until it is back values are not good
	void keep_up(int err)
	{
		if (err == -ESTALE)
			stale_ = true;
	}

	void show(Variable &v, Signal &s)
	{
		bool fits = true;

		if (s.good)
			fits = put(v, s.value.number * v.scale);
		tell(v, s, fits ? 0 : -ERANGE);
		s.good = s.good && fits;
		if (!s.good && v.has_otherwise)
			put(v, v.otherwise);
	}

	void set(Variable &v, double value)
	{
		const Signal &s = map_.signals[v.signal];
		int err = s.id < 0 ? 0 : ows_set(handle_, s.id, value, nullptr);

		keep_up(err);
		tell(v, s, err == -ESTALE ? 0 : err);
	}

	void tell(Variable &v, const Signal &s, int err)
	{
		if (err && err != v.told)
			say(v.text() + " " + s.name + ": " + std::strerror(-err));
		v.told = err;
	}

	static uint32_t beat_ms()
	{
		unsigned long long three_cycles = cycle_ns() * 3 / 1000000;

		return three_cycles > 1000 ? (uint32_t)three_cycles : 1000;
	}

	Map map_;
	ows *handle_ = nullptr;
	std::future<Opened> opening_;
	int64_t next_try_ = 0;
	int told_ = 0;
	bool outputs_ = false, stale_ = false;
};

Layer layer;

#ifndef OPENPLC_V4
class Locked {
public:
	Locked() { pthread_mutex_lock(&bufferLock); }
	~Locked() { pthread_mutex_unlock(&bufferLock); }
};
#endif

} // namespace

#ifdef OPENPLC_V4

// What the runtime looks up: all run one after the other, the cycles in its own thread
extern "C" {

int init(void *args)
{
	runtime = *(const plugin_runtime_args_t *)args;
	try {
		layer.start(runtime.plugin_specific_config_file_path);
	} catch (const std::exception &e) {
		runtime.log_error("owsd: %s", e.what());
		return -1;
	}
	return 0;
}

// Its README says void, the runtime looks at what is returned
int start_loop(void)
{
	return 0;
}

void stop_loop(void)
{
	layer.stop();
}

void cycle_start(void)
{
	layer.in();
}

void cycle_end(void)
{
	layer.out();
}

void cleanup(void)
{
	layer.stop();
}

} // extern "C"

#else

// A PLC that does not know its variables is not to run
void initializeHardware()
{
	try {
		layer.start("");
	} catch (const std::exception &e) {
		say(e.what());
		std::exit(EXIT_FAILURE);
	}
}

void finalizeHardware()
{
	layer.stop();
}

void updateBuffersIn()
{
	Locked lock;

	layer.in();
}

void updateBuffersOut()
{
	Locked lock;

	layer.out();
}

#endif
