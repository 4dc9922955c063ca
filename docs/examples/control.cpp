// SPDX-License-Identifier: MIT
//
// A two-point controller: keeps a temperature with a relay, ten times a second, and shows what a
// control program owes its plant: it uses good values only, it beats, and it says what the output
// is to be when it does not know.
//
//     c++ -std=c++17 control.cpp $(pkg-config --cflags --libs libows) -o control
//     ./control TEMPERATURE RELAY SETPOINT [CYCLES [INSTANCE]]
#include <ows.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

namespace {

class Plant {
public:
	explicit Plant(const char *instance)
	{
		ows *raw = nullptr;
		int err = ows_open(instance, OWS_CONTROL, &raw);

		if (err)
			throw std::runtime_error(std::string("cannot open owsd: ") + std::strerror(-err));
		handle_.reset(raw);
	}

	int find(const char *name) const
	{
		int id = ows_find(handle_.get(), name);

		if (id < 0)
			throw std::runtime_error(std::string("no signal ") + name);
		return id;
	}

	// After a restart or reload of owsd the ids stay right; until it is back values are not good
	void keep_up(int err)
	{
		if (err == -ESTALE)
			ows_reopen(handle_.get());
	}

	bool get(int id, double &value)
	{
		ows_value v;

		keep_up(ows_get(handle_.get(), id, ows_now(), &v));
		value = v.number;
		return ows_good(v.quality) != 0;
	}

	void set(int id, bool on)
	{
		keep_up(ows_set(handle_.get(), id, on ? 1 : 0, nullptr));
	}

	void beat() { keep_up(ows_beat(handle_.get(), 1000)); }

private:
	struct Close {
		void operator()(ows *h) const { ows_close(h); }
	};
	std::unique_ptr<ows, Close> handle_;
};

void control(Plant &plant, int temperature, int relay, double setpoint, long cycles)
{
	constexpr double hysteresis = 0.5;
	auto next = std::chrono::steady_clock::now();
	bool heat = false;

	for (long i = 0; cycles == 0 || i < cycles; i++) {
		double value = 0;

		if (!plant.get(temperature, value))
			heat = false;
		else if (value < setpoint - hysteresis)
			heat = true;
		else if (value > setpoint + hysteresis)
			heat = false;
		plant.set(relay, heat);
		plant.beat();
		next += std::chrono::milliseconds(100);
		std::this_thread::sleep_until(next);
	}
}

} // namespace

int main(int argc, char **argv)
{
	if (argc < 4) {
		std::fprintf(stderr, "usage: control TEMPERATURE RELAY SETPOINT [CYCLES [INSTANCE]]\n");
		return 2;
	}
	try {
		Plant plant(argc > 5 ? argv[5] : nullptr);

		control(plant, plant.find(argv[1]), plant.find(argv[2]), std::atof(argv[3]),
		        argc > 4 ? std::atol(argv[4]) : 0);
	} catch (const std::exception &e) {
		std::fprintf(stderr, "control: %s\n", e.what());
		return 1;
	}
	return 0;
}
