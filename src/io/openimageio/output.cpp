// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tetcast {
namespace {

// The file that a path means which does not exist yet: where a symbolic link, or a chain of them, points to.
std::string follow_links(std::string path) {
  char target[4096];
  for (int i = 0; i < 40; i++) { // as many as the system follows
    const ssize_t length = ::readlink(path.c_str(), target, sizeof target);
    if (length <= 0 || length == ssize_t(sizeof target))
      break;
    const size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos || target[0] == '/' ? "" : path.substr(0, slash + 1);
    path = folder + std::string(target, size_t(length));
  }
  return path;
}

// Marks a new file as being written: who finds it without the lock may take it for the left-over of a killed process.
// False: somebody did so before we had the lock.
bool lock(int descriptor) {
  struct stat status;
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  return locked ? ::fstat(descriptor, &status) != 0 || status.st_nlink > 0 : errno != EWOULDBLOCK;
}

} // namespace

NewFile::~NewFile() {
  if (m_file)
    std::fclose(m_file);
  if (!m_temporary.empty())
    ::unlink(m_temporary.c_str());
  if (m_lock >= 0)
    ::close(m_lock);
}

int NewFile::open(const std::string &path) {
  m_target = path;
  struct stat status;
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists) {
    if (S_ISDIR(status.st_mode))
      return EISDIR;
    if (!S_ISREG(status.st_mode)) // renaming would replace a device or pipe
      return EINVAL;
    if (::access(path.c_str(), W_OK) != 0)
      return errno;
    std::unique_ptr<char, decltype(&std::free)> real(::realpath(path.c_str(), nullptr), &std::free);
    if (!real)
      return errno;
    m_target = real.get();
  } else if (errno != ENOENT) {
    return errno;
  } else {
    m_target = follow_links(path);
  }

  const size_t slash = m_target.rfind('/');
  const size_t dot = m_target.rfind('.');
  const std::string folder = slash == std::string::npos ? "" : m_target.substr(0, slash + 1);
  const std::string extension =
      dot == std::string::npos || (slash != std::string::npos && dot < slash) ? "" : m_target.substr(dot);
  static std::atomic<unsigned> counter{0};
  int descriptor = -1;
  do {
    m_temporary = folder + ".tetcast-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + extension;
    descriptor =
        ::open(m_temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, exists ? status.st_mode & 0777 : 0666);
    if (descriptor >= 0 && !lock(descriptor)) {
      ::close(descriptor);
      descriptor = -1;
      errno = EEXIST;
    }
  } while (descriptor < 0 && errno == EEXIST);
  if (descriptor < 0) {
    const int error = errno;
    m_temporary.clear();
    return error;
  }
  if (exists) { // what is replaced keeps its mode and, where we may, its owner: a private file stays private
    if (::fchown(descriptor, status.st_uid, status.st_gid) != 0)
      status.st_mode &= 0777;
    (void)::fchmod(descriptor, status.st_mode & 07777);
  }
  m_lock = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  m_file = ::fdopen(descriptor, "w+b");
  if (!m_file) {
    const int error = errno;
    ::close(descriptor);
    return error;
  }
  return 0;
}

int NewFile::publish() {
  errno = 0;
  std::FILE *const file = m_file;
  m_file = nullptr;
  if (std::fclose(file) != 0)
    return errno ? errno : EIO;
  if (std::rename(m_temporary.c_str(), m_target.c_str()) != 0)
    return errno;
  m_temporary.clear();
  return 0;
}

bool CheckedProxy::seek(int64_t offset) {
  m_pos = offset;
  return true;
}

size_t CheckedProxy::write(const void *data, size_t size) {
  pwrite(data, size, m_pos);
  m_pos += static_cast<int64_t>(size);
  return size;
}

size_t CheckedProxy::pwrite(const void *data, size_t size, int64_t offset) {
  if (size == 0)
    return 0;
  errno = 0;
  if (m_errno == 0 && offset != m_file_position && ::fseeko(m_file, offset, SEEK_SET) != 0)
    fail();
  if (m_errno == 0 && std::fwrite(data, 1, size, m_file) != size)
    fail();
  m_file_position = offset + static_cast<int64_t>(size);
  m_size = std::max(m_size, static_cast<size_t>(m_file_position));
  return size;
}

size_t CheckedProxy::read(void *data, size_t size) {
  const size_t count = pread(data, size, m_pos);
  m_pos += static_cast<int64_t>(count);
  return count;
}

size_t CheckedProxy::pread(void *data, size_t size, int64_t offset) {
  m_file_position = -1; // a seek must lie between reading and writing
  return ::fseeko(m_file, offset, SEEK_SET) == 0 ? std::fread(data, 1, size, m_file) : 0;
}

} // namespace tetcast
