#include "tests/fuzz/fuzz_seeds.h"

#include <cstdint>
#include <string_view>

#include "curvecast/v1/curvecast.pb.h"
#include "curvecast/v1/web_socket.pb.h"
#include "tests/core/mesh_io/three_mf_writer.h"
#include "tests/fuzz/message_seeds.h"

namespace curvecast::fuzzing {
namespace {

std::string little_endian(std::uint64_t number, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(number >> 8 * i & 0xff);
  return out;
}

void add_cache(std::vector<Seed>& seeds) {
  constexpr int kFiles = 5;
  constexpr std::uint8_t kWhole = 1 << 3, kMends = 1 << 4, kCuts = 1 << 5, kGrows = 1 << 6, kRefines = 1 << 7;
  for (int file = 0; file < kFiles; ++file) {
    const auto add = [&](int bits, std::uint16_t cut_at, const std::string& rest) {
      seeds.push_back({"cache", little_endian(bits + file, 1) + little_endian(cut_at, 2) + rest});
    };
    for (const int use : {0, int{kGrows}, int{kRefines}, kGrows | kRefines}) {
      add(use, 0, "");
      for (const std::uint16_t cut_at : {0x0000, 0x0001, 0x0100, 0x2000, 0x2001, 0x8000, 0x8001, 0xffff})
        add(kCuts | use, cut_at, "");
    }
    add(kWhole, 0, "");
    add(kWhole | kMends, 0, std::string(1000, '\0'));
    // Header, table, and some of what follows.
    for (std::uint64_t offset = 0; offset < 8192; offset = offset < 512 ? offset + 8 : offset + 256) {
      for (const std::string& bytes : {std::string(8, '\xff'), std::string(8, '\0'), little_endian(1, 8)}) {
        add(kMends | kRefines, 0, little_endian(offset, 3) + little_endian(bytes.size(), 1) + bytes);
      }
    }
    for (const std::uint64_t offset : {1, 64, 2000, 20000}) {
      add(kMends, 0, little_endian(offset, 3) + '\0');
      add(kMends, 0, little_endian(offset, 3) + '\xc8' + "inserted");
    }
  }
}

void add_models(std::vector<Seed>& seeds) {
  const std::string groups =
      "<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#FF0000\"/></basematerials><m:colorgroup id=\"6\">"
      "<m:color color=\"#00FF00\"/><m:color color=\"#0000FF80\"/></m:colorgroup>\n";
  const std::string whole =
      "<object id=\"3\"><components><component objectid=\"1\"/><component objectid=\"2\" "
      "transform=\"-1 0 0 0 1 0 0 0 1 3 0 0\"/></components></object>\n";
  const std::string one = three_mf_object(1, tetrahedron(), "pid=\"5\" pindex=\"0\"");
  const std::string two = three_mf_object(2, tetrahedron(), "", " pid=\"6\" p1=\"0\" p2=\"1\"");
  for (const char* item : {"<item objectid=\"1\"/>", "<item objectid=\"3\" transform=\"1 0 0 0 1 0 0 0 1 0 0 7\"/>"}) {
    seeds.push_back({"3mf", three_mf_model(groups + one + two + whole, item, "requiredextensions=\"m p\"")});
  }
}

void add_formula(std::vector<Seed>& seeds) {
  std::string power = "x";
  while (power.size() < 990) power += "^x";
  for (const std::string& text :
       {std::string("1"), std::string("(x > 0) * (1 + abs(mean))"), std::string("nx + ny * nz / gauss"), std::string("k2 - k1"),
        std::string("heat > 0.5 ? sin(x) : cos(y)"), std::string("min(x, y, z) ^ max(1, 2)"),
        std::string("x == y && z != 1 || !x"), std::string("sqrt(-1)"), std::string("1 / 0"), std::string("x = 2"),
        std::string("1, 2"), std::string("nothing + 1"), std::string("rint(atan2(x, 1e300)) + _pi - _e"),
        std::string(400, '(') + "x" + std::string(400, ')'), std::string(500, '-') + "x", power, std::string(1001, '1'),
        std::string("sum(") + std::string(300, '1') + ")"}) {
    seeds.push_back({"formula", '\x10' + text});
    seeds.push_back({"formula", '\x01' + text});
  }
}

void add_preprocess(std::vector<Seed>& seeds) {
  const auto add = [&](const std::string& ways, std::uint8_t ending, std::uint8_t where, const std::string& places,
                       const std::string& corners) {
    // 50 points, omega 3.
    seeds.push_back({"preprocess", little_endian(50, 2) + '\x02' + ways + little_endian(ending, 1) + little_endian(where, 1) +
                                       little_endian(places.size() / 3 - 3, 1) + places + corners});
  };
  constexpr char kLow = '\x68', kMiddle = '\x78', kHigh = '\x88';  // -1, 0 and 1
  std::string cube;
  for (int v = 0; v < 8; ++v) {
    for (int i = 0; i < 3; ++i) cube += (v >> i & 1) != 0 ? kHigh : kLow;
  }
  std::string cube_faces;
  for (const int v :
       {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}) {
    cube_faces += static_cast<char>(v);
  }
  std::string grid, grid_faces;
  for (int v = 0; v < 25; ++v) grid += {static_cast<char>(kLow + 8 * (v % 5)), static_cast<char>(kLow + 8 * (v / 5)), kMiddle};
  for (int v = 0; v < 19; ++v) {
    if (v % 5 == 4) continue;
    for (const int corner : {v, v + 1, v + 5, v + 1, v + 6, v + 5}) grid_faces += static_cast<char>(corner);
  }
  for (const std::string& ways : {std::string("\xff\0", 2), std::string("\x41\x01", 2), std::string("\x01\x02", 2),
                                  std::string("\x00\x03", 2), std::string("\xf0\x00", 2)}) {
    for (const std::uint8_t ending : {0, 2, 3, 11, 43}) {
      for (const std::uint8_t where : {0x00, 0x04, 0x07, 0x38}) {
        add(ways, ending, where, cube, cube_faces);
        add(ways, ending, where, grid, grid_faces);
        add(ways, ending, where, cube, cube_faces.substr(0, 30) + cube_faces);
        add(ways, ending, where, cube.substr(0, 12), std::string("\0\1\2", 3));
      }
    }
  }
}

void add_proxy(std::vector<Seed>& seeds) {
  for (const char* const text :
       {"PROXY TCP4 198.51.100.1 10.0.0.2 4711 443\r\n", "PROXY TCP6 2001:db8::7 ::1 4711 443\r\nGET / HTTP/1.1\r\n\r\n",
        "PROXY UNKNOWN\r\n", "PROXY UNKNOWN ffff::1 ffff::2 1 2\r\nPRI * HTTP/2.0", "PROXY TCP4 198.51.100.1",
        "GET / HTTP/1.1\r\n"}) {
    seeds.push_back({"proxy", text});
  }
  // Version and command, family, and what follows their length.
  const auto add = [&](std::uint8_t command, std::uint8_t family, const std::string& rest) {
    seeds.push_back({"proxy", std::string("\r\n\r\n\0\r\nQUIT\n", 12) + static_cast<char>(command) + static_cast<char>(family) +
                                  static_cast<char>(rest.size() >> 8) + static_cast<char>(rest.size() & 0xff) + rest});
  };
  const std::string four("\xc6\x33\x64\x01\x0a\0\0\x02\x12\x67\x01\xbb", 12);
  const std::string mapped = std::string(10, '\0') + "\xff\xff" + four.substr(0, 4);
  add(0x21, 0x11, four);
  add(0x21, 0x11, four + std::string("\x04\0\x03more", 7));
  add(0x21, 0x21, std::string(32, '\x20') + four.substr(8));
  add(0x21, 0x21, mapped + mapped + four.substr(8));
  add(0x20, 0x00, "");
  add(0x21, 0x31, std::string(216, 'u'));
  add(0x21, 0x11, std::string(4080, 'x'));
  add(0x21, 0x11, std::string(4081, 'x'));
}

void add_settings(std::vector<Seed>& seeds) {
  const std::string digest(64, 'a');
  for (const std::string& input :
       {"Bearer secret\nanna " + digest + "\n# nobody\nbert " + std::string(64, 'B') + " 1800000000\n",
        std::string("Bearer secret\nanna 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b")}) {
    seeds.push_back({"settings", '\0' + input});
  }
  for (const std::string& input : {std::string("ipv4:10.0.0.1:4711\n1.2.3.4, 10.0.0.2\n10.0.0.3\n10.0.0.0/8\nfd00::/8"),
                                   std::string("ipv6:%5B::1%5D:4711\n[2001:db8::1]:80, 1.2.3.4:80\nunknown, ::1\n::1\n::/0"),
                                   std::string("ipv6:%5Bfe80::1%25eth0%5D:1\n\n\nfe80::/10")}) {
    seeds.push_back({"settings", '\1' + input});
  }
  for (const char* const input : {"127.0.0.1:50051", "[::1]:0", "localhost:65535", ":1", "a:b:2", "[]:3"}) {
    seeds.push_back({"settings", '\2' + std::string(input)});
  }
  for (const char* const input : {"https://example.org\nexample.org\n*", "http://127.0.0.1:8080\n127.0.0.1:8080",
                                  "http://[::1]:80\n[::1]:80\nhttps://a.b", "http://viewer.local\nviewer.local"}) {
    seeds.push_back({"settings", '\3' + std::string(input)});
  }
  for (const char* const input : {"--listen=0.0.0.0:1\n--open-to-all", "--memory=3GB\n--max-upload=1.5mb\n--cache-size\n10 KiB",
                                  "--trusted-proxy\n10.0.0.0/8", "--web-origin=https://example.org\n--web-origin\n*",
                                  "--base-density=curvature:kind=mean\n--omega=3", "--help", "--drain=1e3", "--points=100\n-n\n5",
                                  "--quiet\n--verbose", "--log-format=json\n--max-view-rate=1.5"}) {
    seeds.push_back({"settings", '\4' + std::string(input)});
  }
  for (const char* const input :
       {"listen=0.0.0.0:1\nopen-to-all=true", "memory=3GB\nmax-upload=10MB",
        "web-origin=https://a.org; https://b.org\ntrusted-proxy=::1", "max-sessions=0", "quiet=no", "open=a.ply;b.obj"}) {
    seeds.push_back({"settings", '\5' + std::string(input)});
  }
  for (const char* const input : {"listen = \"0.0.0.0:1\"\nopen-to-all = true\n", "memory=\"3GB\"\nmax-upload=1000\n",
                                  "web-origin=[\"https://a.org\", \"*\"]\n", "# nothing\n", "[table]\nlisten='x'\n",
                                  "listen = \"a#b\"\n", "drain = 1.5\ndrain = 2\n", "open = \"\"\n"}) {
    seeds.push_back({"settings", '\6' + std::string(input)});
  }
}

std::string binary_message(const std::string& bytes) { return '\x82' + little_endian(bytes.size(), 2) + bytes; }

std::string call_message(std::uint32_t call, const std::string& method, const std::string& message, bool ends = false) {
  v1::CallRequest request;
  request.set_call(call);
  request.set_method(method);
  request.set_message(message);
  request.set_half_close(ends);
  return binary_message(request.SerializeAsString());
}

void add_websocket(std::vector<Seed>& seeds) {
  for (const char* const head :
       {"GET / HTTP/1.1\r\nHost: a\r\n\r\n",
        "HEAD /healthz HTTP/1.1\r\n\r\nGET /readyz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n", "GET /metrics?x HTTP/1.1\r\n\r\n",
        "POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\n12345", "GET /v1/socket HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n",
        "GET /v1/socket HTTP/1.1\r\n\r\n",
        "GET /v1/socket HTTP/1.1\r\nHost: viewer.example.org\r\nOrigin: https://example.org\r\nConnection: Upgrade\r\nUpgrade: "
        "websocket\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nX-Forwarded-For: 1.2.3.4\r\n"
        "Sec-WebSocket-Protocol: curvecast.v1\r\nSec-WebSocket-Extensions: permessage-deflate\r\n\r\n"}) {
    seeds.push_back({"websocket", std::string(1, '\0') + head});
  }
  v1::StreamViewsRequest open, view, ack;
  open.mutable_open()->set_session_id(std::string(32, 'a'));
  view.mutable_view()->set_sequence(1);
  view.mutable_view()->mutable_sample()->set_points(10);
  ack.mutable_ack()->set_sequence(1);
  const std::string views = call_message(1, "StreamViews", open.SerializeAsString()) +
                            call_message(1, "", view.SerializeAsString()) + call_message(1, "", ack.SerializeAsString(), true);
  v1::CallRequest cancel;
  cancel.set_call(2);
  cancel.set_cancel(true);
  const std::string calls = call_message(2, "ListSessions", "", true) + call_message(3, "UploadMesh", "bytes") +
                            call_message(3, "", "more", true) + call_message(4, "NoSuchMethod", "") +
                            call_message(1, "GetSession", "") + binary_message(cancel.SerializeAsString());
  const std::string control = std::string("\x89\x02\0hi\x8a\0\0", 8) + std::string("\x02\x03\0abc\x80\x01\0d", 10);
  for (const char bits : {'\x03', '\x07', '\x0f'}) {
    for (const std::string& messages : {views, calls, control + views + calls, std::string("\x88\x02\0\x03\xe8", 5),
                                        std::string("\x81\x02\0hi", 5), binary_message("no CallRequest"), calls + calls}) {
      seeds.push_back({"websocket", bits + messages});
    }
  }
  seeds.push_back({"websocket", std::string("\x01\x82\xff\0\0\0\0\x7f\xff\xff\xff\1\2\3\4", 15)});
  seeds.push_back({"websocket", std::string("\x01\x82\x05hello", 8)});
}

}  // namespace

std::vector<Seed> seeds() {
  std::vector<Seed> seeds;
  add_cache(seeds);
  add_models(seeds);
  add_formula(seeds);
  add_messages(seeds);
  add_preprocess(seeds);
  add_proxy(seeds);
  add_settings(seeds);
  add_websocket(seeds);
  return seeds;
}

}  // namespace curvecast::fuzzing
