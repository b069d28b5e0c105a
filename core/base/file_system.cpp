#include "core/base/file_system.h"

#ifdef __linux__
#include <sys/vfs.h>
#endif

#include <algorithm>
#include <array>

namespace curvecast {
namespace {

// See statfs(2) and the kernel's linux/magic.h.
constexpr std::array<std::uint32_t, 18> kRemoteTypes = {
    0x00006969,  // NFS
    0xff534d42,  // CIFS
    0xfe534d42,  // SMB2
    0x0000517b,  // SMB
    0x65735546,  // FUSE: sshfs, s3fs, GlusterFS, virtiofs ...
    0x00c36400,  // Ceph
    0x01021997,  // 9P
    0x5346414f,  // AFS
    0x6b414653,  // kAFS
    0x73757245,  // Coda
    0x0000564c,  // NCP
    0x0bd00bd0,  // Lustre
    0x47504653,  // GPFS
    0x19830326,  // BeeGFS
    0xaad7aaea,  // PanFS
    0x7461636f,  // OCFS2
    0x01161970,  // GFS2
    0x786f4256,  // VirtualBox's shared folders
};

}  // namespace

bool is_local_type(std::uint32_t type) { return std::ranges::find(kRemoteTypes, type) == kRemoteTypes.end(); }

bool is_on_local_disk(int descriptor) {
#ifdef __linux__
  struct statfs status = {};
  return ::fstatfs(descriptor, &status) != 0 || is_local_type(static_cast<std::uint32_t>(status.f_type));
#else
  (void)descriptor;
  return true;
#endif
}

}  // namespace curvecast
