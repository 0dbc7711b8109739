#include "viewer/script.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "cli/output.h"
#include "cli/values.h"
#include "viewer/app.h"

namespace candela::viewer {

namespace {

constexpr int kMostPixels = 16384;
constexpr double kPatience = 120.0;  // seconds that a wait may take unless it says otherwise

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

vec2 parse_place(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) throw cli::UsageError("'" + text + "' is no X,Y");
  return {static_cast<float>(cli::parse_count(text.substr(0, comma), 0, kMostPixels)),
          static_cast<float>(cli::parse_count(text.substr(comma + 1), 0, kMostPixels))};
}

constexpr std::array<std::pair<std::string_view, gl::MouseButton>, 3> kButtons{
    {{"left", gl::MouseButton::left}, {"right", gl::MouseButton::right}, {"middle", gl::MouseButton::middle}}};

constexpr std::array<std::pair<std::string_view, gl::Key>, 8> kNamedKeys{{{"space", gl::Key::space},
                                                                          {"escape", gl::Key::escape},
                                                                          {"tab", gl::Key::tab},
                                                                          {"enter", gl::Key::enter},
                                                                          {"backspace", gl::Key::backspace},
                                                                          {"pageup", gl::Key::page_up},
                                                                          {"pagedown", gl::Key::page_down},
                                                                          {"del", gl::Key::del}}};

/// "ctrl+R", "shift+V", "space".
struct Chord {
  gl::Key key = gl::Key::none;
  gl::Modifiers modifiers;
};

void add_modifier(const std::string& word, gl::Modifiers& modifiers) {
  if (word == "shift")
    modifiers.shift = true;
  else if (word == "ctrl")
    modifiers.control = true;
  else if (word == "alt")
    modifiers.alt = true;
  else
    throw cli::UsageError("'" + word + "' is none of shift, ctrl, alt");
}

Chord parse_chord(std::string text) {
  Chord chord;
  for (std::size_t plus = text.find('+'); plus != std::string::npos && plus > 0; plus = text.find('+')) {
    add_modifier(text.substr(0, plus), chord.modifiers);
    text = text.substr(plus + 1);
  }
  for (const auto& [name, key] : kNamedKeys) {
    if (text == name) chord.key = key;
  }
  if (text.size() == 1 && text[0] > ' ' && text[0] <= '`') chord.key = static_cast<gl::Key>(text[0]);
  if (chord.key == gl::Key::none) throw cli::UsageError("'" + text + "' is no key");
  return chord;
}

/// What follows the places of a drag or a click.
struct Press {
  gl::MouseButton button = gl::MouseButton::left;
  gl::Modifiers modifiers;
};
Press parse_press(const std::vector<std::string>& words, std::size_t from) {
  Press press;
  for (std::size_t i = from; i < words.size(); ++i) {
    const auto* found =
        std::find_if(kButtons.begin(), kButtons.end(), [&](const auto& row) { return row.first == words[i]; });
    if (found != kButtons.end())
      press.button = found->second;
    else
      add_modifier(words[i], press.modifiers);
  }
  return press;
}

/// How many words a step has, itself included.
struct StepForm {
  std::string_view name;
  std::size_t least, most;
};
constexpr auto kForms = std::to_array<StepForm>({{"wait", 2, 4},
                                                 {"sleep", 2, 2},
                                                 {"key", 2, 2},
                                                 {"type", 2, 2},
                                                 {"move", 2, 2},
                                                 {"drag", 3, 6},
                                                 {"click", 2, 5},
                                                 {"scroll", 2, 3},
                                                 {"drop", 2, 9},
                                                 {"size", 2, 2},
                                                 {"save", 2, 3},
                                                 {"window", 2, 2},
                                                 {"state", 1, 1},
                                                 {"close", 1, 1}});

/// Words are divided by blanks; in quotation marks one may have some.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream in(line);
  std::string word;
  while (in >> std::ws && in.peek() != '#' && in.peek() != std::char_traits<char>::eof()) {
    if (in.peek() == '"') {
      in.get();
      if (!std::getline(in, word, '"') || in.eof()) throw cli::UsageError("a quotation mark has no end");
    } else {
      in >> word;
    }
    words.push_back(word);
  }
  return words;
}

/// Refuses what play_step() could not play.
void check(const std::vector<std::string>& w) {
  const auto* form = std::find_if(kForms.begin(), kForms.end(), [&](const StepForm& f) { return f.name == w[0]; });
  if (form == kForms.end()) throw cli::UsageError("unknown: " + w[0]);
  if (w.size() < form->least || w.size() > form->most) throw cli::UsageError(w[0] + " has other words after it");
  if (w[0] == "wait" && w.size() > 2) cli::parse_count(w[2], 0, 1 << 20);
  if (w[0] == "wait" && w.size() > 3) cli::parse_duration(w[3]);
  if (w[0] == "sleep") cli::parse_duration(w[1]);
  if (w[0] == "key") parse_chord(w[1]);
  if (w[0] == "move" || w[0] == "drag" || w[0] == "click") parse_place(w[1]);
  if (w[0] == "drag") parse_place(w[2]), parse_press(w, 3);
  if (w[0] == "click") parse_press(w, 2);
  if (w[0] == "scroll") cli::parse_number(w[1], -100.0f, 100.0f);
  if (w[0] == "scroll" && w.size() > 2) parse_place(w[2]);
  if (w[0] == "size") cli::parse_size(w[1]);
  if (w[0] == "save" && w.size() > 2) cli::parse_size(w[2]);
  if (w[0] == "save" || w[0] == "window") check_output_extension(w[1]);
  if (w[0] == "window" && cli::is_linear_format(w[1]))
    throw cli::UsageError(w[1] + ": what a screen shows is not linear");
}

using Kind = gl::WindowEvent::Kind;

void point(App& app, vec2 at, gl::Modifiers modifiers = {}) {
  app.handle({.kind = Kind::pointer, .position = at, .modifiers = modifiers});
}

void push(App& app, vec2 at, const Press& press, bool is_down) {
  app.handle(
      {.kind = Kind::button, .position = at, .button = press.button, .is_down = is_down, .modifiers = press.modifiers});
}

}  // namespace

Script::Script(const std::filesystem::path& file) : file_(file) {
  std::ifstream in(file);
  if (!in) throw Error("cannot be read", file.string());
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    Step step{number, {}};
    try {
      step.words = words_of(line);
      if (!step.words.empty()) check(step.words);
    } catch (const cli::UsageError& error) {
      throw Error(error.what(), where(step));
    } catch (const Error& error) {
      throw Error(error.message(), where(step));
    }
    if (!step.words.empty()) steps_.push_back(std::move(step));
  }
}

std::string Script::where(const Step& step) const { return file_.string() + ":" + std::to_string(step.line); }

bool Script::wait(const App& app, const Step& step) {
  const int count = step.words.size() > 2 ? cli::parse_count(step.words[2], 0, 1 << 20) : 1;
  const double patience = step.words.size() > 3 ? cli::parse_duration(step.words[3]) : kPatience;
  if (app.has(step.words[1], count)) return true;
  if (now_s() - since_s_ > patience) throw Error("has not come: " + step.words[1], where(step));
  return false;
}

bool Script::play(App& app) {
  if (has_ended()) return false;
  const Step& step = steps_[next_];
  if (since_s_ < 0.0) since_s_ = now_s();
  if (!play_step(app, step)) return false;
  ++next_;
  since_s_ = -1.0;
  return true;
}

/// Whether it is done.
bool Script::play_step(App& app, const Step& step) {
  const std::vector<std::string>& w = step.words;
  if (w[0] == "wait") return wait(app, step);
  if (w[0] == "sleep") return now_s() - since_s_ >= cli::parse_duration(w[1]);
  if (w[0] == "key") {
    const Chord chord = parse_chord(w[1]);
    for (const bool is_down : {true, false}) {
      app.handle({.kind = Kind::key, .is_down = is_down, .key = chord.key, .modifiers = chord.modifiers});
    }
  }
  if (w[0] == "type") {
    for (const char c : w[1]) app.handle({.kind = Kind::text, .character = static_cast<unsigned char>(c)});
  }
  if (w[0] == "move") point(app, parse_place(w[1]));
  if (w[0] == "click") {
    // ImGui has to see the pointer arrive before it is pressed, and it pressed before it is let go.
    const vec2 at = parse_place(w[1]);
    const Press press = parse_press(w, 2);
    if (stage_ == 0) point(app, at, press.modifiers);
    if (stage_ == 2) push(app, at, press, true);
    if (stage_ == 4) push(app, at, press, false);
    if (++stage_ <= 5) return false;
  }
  if (w[0] == "drag") {
    constexpr int kParts = 8;
    const vec2 from = parse_place(w[1]), to = parse_place(w[2]);
    const Press press = parse_press(w, 3);
    if (stage_ == 0) point(app, from, press.modifiers);
    if (stage_ == 2) push(app, from, press, true);
    if (stage_ > 2 && stage_ <= 2 + kParts) {
      point(app, glm::mix(from, to, static_cast<float>(stage_ - 2) / kParts), press.modifiers);
    }
    if (stage_ == 4 + kParts) push(app, to, press, false);
    if (++stage_ <= 5 + kParts) return false;
  }
  if (w[0] == "scroll") {
    if (w.size() > 2) point(app, parse_place(w[2]));
    app.handle({.kind = Kind::scroll, .scroll = vec2(0.0f, cli::parse_number(w[1], -100.0f, 100.0f))});
  }
  if (w[0] == "drop") app.handle({.kind = Kind::drop, .files = {w.begin() + 1, w.end()}});
  if (w[0] == "size") app.resize(cli::parse_size(w[1]));
  if (w[0] == "save") app.save_picture(w.size() > 2 ? cli::parse_size(w[2]) : ivec2(0), w[1]);
  if (w[0] == "window") app.save_window(w[1]);
  if (w[0] == "state") std::cout << app.state() << std::endl;  // at once, for whoever waits
  if (w[0] == "close") app.close();
  stage_ = 0;
  return true;
}

}  // namespace candela::viewer
