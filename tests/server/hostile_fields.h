// Every field of a message, one after the other, with values that nobody should send.
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace curvecast::server {

/// Calls visit(path) for each change of a field of `message` or of a message within it, while it is changed; afterwards all is as
/// before. Messages that are not set are visited too. Changes: numbers that are NaN, infinite, negative, huge; unknown enum
/// values; strings that are long, binary or hostile paths; many elements where there may be several.
class HostileFields {
 public:
  using Visit = std::function<void(const std::string& path)>;

  explicit HostileFields(Visit visit) : visit_(std::move(visit)) {}

  void run(google::protobuf::Message& message, const std::string& path = "", int depth = 0) {
    constexpr int kDeepest = 5;
    if (depth > kDeepest) return;
    const google::protobuf::Descriptor& type = *message.GetDescriptor();
    for (int i = 0; i < type.field_count(); ++i) change(message, *type.field(i), path + "." + type.field(i)->name(), depth);
  }

 private:
  using Field = google::protobuf::FieldDescriptor;
  static constexpr int kMany = 1000;

  void change(google::protobuf::Message& message, const Field& field, const std::string& path, int depth) {
    const std::unique_ptr<google::protobuf::Message> saved(message.New());
    saved->CopyFrom(message);
    const google::protobuf::Reflection& to = *message.GetReflection();
    const auto each = [&](const auto& values, const auto& set, const auto& add) {
      for (const auto& value : values) {
        if (field.is_repeated()) {
          add(value);
          visit_(path + ", one more");
          for (int i = 0; i < kMany; ++i) add(value);
          visit_(path + ", many");
        } else {
          set(value);
          visit_(path);
        }
        message.CopyFrom(*saved);
      }
    };
    using Reals = std::vector<double>;
    const Reals reals = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity(),
                         -1e300,
                         -1,
                         0,
                         5e-324,
                         1e-30,
                         1e30,
                         1e300};
    switch (field.cpp_type()) {
      case Field::CPPTYPE_DOUBLE:
        each(
            reals, [&](double v) { to.SetDouble(&message, &field, v); }, [&](double v) { to.AddDouble(&message, &field, v); });
        break;
      case Field::CPPTYPE_FLOAT:
        each(
            reals, [&](double v) { to.SetFloat(&message, &field, static_cast<float>(v)); },
            [&](double v) { to.AddFloat(&message, &field, static_cast<float>(v)); });
        break;
      case Field::CPPTYPE_UINT64:
        each(
            std::vector<std::uint64_t>{0, 1, std::uint64_t{1} << 32, std::uint64_t{1} << 63, ~std::uint64_t{0}},
            [&](std::uint64_t v) { to.SetUInt64(&message, &field, v); },
            [&](std::uint64_t v) { to.AddUInt64(&message, &field, v); });
        break;
      case Field::CPPTYPE_UINT32:
        each(
            std::vector<std::uint32_t>{0, 1, std::uint32_t{1} << 31, ~std::uint32_t{0}},
            [&](std::uint32_t v) { to.SetUInt32(&message, &field, v); },
            [&](std::uint32_t v) { to.AddUInt32(&message, &field, v); });
        break;
      case Field::CPPTYPE_ENUM:
        each(
            std::vector<int>{0, 99, -1, std::numeric_limits<int>::max()}, [&](int v) { to.SetEnumValue(&message, &field, v); },
            [&](int v) { to.AddEnumValue(&message, &field, v); });
        break;
      case Field::CPPTYPE_BOOL:
        each(
            std::vector<bool>{false, true}, [&](bool v) { to.SetBool(&message, &field, v); },
            [&](bool v) { to.AddBool(&message, &field, v); });
        break;
      case Field::CPPTYPE_STRING:
        each(
            std::vector<std::string>{"", std::string(1, '\0'), "../../../etc/passwd", std::string(100'000, 'x'), "%s%n%s\n\"'",
                                     std::string(field.is_repeated() ? 10 : 3'000'000, '\x7f')},
            [&](const std::string& v) { to.SetString(&message, &field, v); },
            [&](const std::string& v) { to.AddString(&message, &field, v); });
        break;
      case Field::CPPTYPE_MESSAGE:
        change_message(message, field, path, depth);
        message.CopyFrom(*saved);
        break;
      default:
        break;
    }
  }

  void change_message(google::protobuf::Message& message, const Field& field, const std::string& path, int depth) {
    const google::protobuf::Reflection& to = *message.GetReflection();
    if (!field.is_repeated()) {
      google::protobuf::Message& inner = *to.MutableMessage(&message, &field);
      visit_(path);
      run(inner, path, depth + 1);
      return;
    }
    if (to.FieldSize(message, &field) == 0) {
      to.AddMessage(&message, &field);
      visit_(path + ", an empty one");
    }
    run(*to.MutableRepeatedMessage(&message, &field, 0), path + "[0]", depth + 1);
    for (int i = 0; i < kMany; ++i) {
      to.AddMessage(&message, &field)->CopyFrom(to.GetRepeatedMessage(message, &field, 0));
    }
    visit_(path + ", many");
  }

  const Visit visit_;
};

}  // namespace curvecast::server
