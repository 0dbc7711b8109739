#!/usr/bin/env bash
# nlohmann-json: a parse with a callback, even one that keeps everything, takes time that grows with the square of how many objects
# an array holds; without one it grows with their number. (At the end of each object its array is searched from the start for
# something to discard.) A glTF of 100,000 nodes is such an array. Seen with 3.11.2 (Debian 12) and 3.11.3 (Debian 13); a pass of its
# own through sax_parse, after the parse, does not grow so.
# Printed: "10,000 objects 0.156 s, 40,000 1.566 s: 10 times; without a callback 0.0038 s".
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download --quiet --quiet nlohmann-json3-dev=3.11.2-2 2>download.log || { cat download.log; exit 1; }
dpkg -x nlohmann-json3-dev_*.deb package
cat >try.cpp <<'TEXT'
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

using nlohmann::json;

double parse_s(int objects, bool has_callback) {
  std::string text = "[{}";
  for (int i = 1; i < objects; ++i) text += ",{}";
  text += "]";
  const auto begin = std::chrono::steady_clock::now();
  const auto keep = [](int, json::parse_event_t, json&) { return true; };
  const json parsed = has_callback ? json::parse(text, keep) : json::parse(text);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  return parsed.size() == static_cast<std::size_t>(objects) ? time.count() : -1.0;
}

int main() {
  const double few = parse_s(10000, true), many = parse_s(40000, true), plain = parse_s(40000, false);
  std::printf("10,000 objects %.3f s, 40,000 %.3f s: %.0f times; without a callback %.4f s\n", few, many, many / few, plain);
  return many > 8.0 * few && many > 50.0 * plain ? 0 : 1;
}
TEXT
g++ -std=c++17 -O2 -isystem package/usr/include try.cpp -o try
./try || { echo "the library behaves otherwise now"; exit 1; }
