// One connection to a server, by libcurl. It is used by one thread at a time.
#pragma once

#include <curl/curl.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#if defined(REVISIT_WITH_ZSTD)
#include <zstd.h>
#endif

#include "result.hpp"

namespace revisit {

/// Where the server is, and how long to wait for it.
struct Endpoint {
    /// Such as `http://127.0.0.1:7878`.
    std::string url;
    /// An API key's secret; empty if the server has no keys.
    std::string key;
    long connect_timeout_ms = 2'000;
    /// Of a whole request. A loop query that waits for a language model (`max_wait_ms`) needs more.
    long timeout_ms = 15'000;
    /// File with the certificates to trust for https; empty for the system's own.
    std::string ca_file;
    /// A longer answer is refused.
    std::size_t max_answer_bytes = std::size_t{64} << 20;
};

namespace detail {

struct Request {
    std::string method;
    /// Path and query, already encoded.
    std::string target;
    std::string body;
    std::string content_type = "application/json";
    std::vector<std::pair<std::string, std::string>> headers;
};

struct Response {
    int status = 0;
    std::string body;
    double retry_after_s = -1;
    bool is_replayed = false;
};

/// Encodes one segment of a path, or a value of a query.
inline std::string percent_encoded(const std::string& text) {
    constexpr char hex[] = "0123456789ABCDEF";
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == ':' || c == '-' || c == '~';
        if (plain) {
            out += c;
        } else {
            out += '%';
            out += hex[byte >> 4];
            out += hex[byte & 15];
        }
    }
    return out;
}

/// Compresses a body if that gains something; whether it did.
inline bool compress(std::string& body) {
#if defined(REVISIT_WITH_ZSTD)
    // A smaller body gains nothing, and the server refuses one that becomes more than 64 times its size.
    constexpr std::size_t min_bytes = 1024, max_ratio = 60;
    // Descriptors do not compress: a higher level costs time alone.
    constexpr int level = 1;
    if (body.size() < min_bytes) return false;
    std::string smaller(ZSTD_compressBound(body.size()), '\0');
    const std::size_t size = ZSTD_compress(smaller.data(), smaller.size(), body.data(), body.size(), level);
    if (ZSTD_isError(size) || size >= body.size() || body.size() >= max_ratio * size) return false;
    smaller.resize(size);
    body = std::move(smaller);
    return true;
#else
    (void)body;
    return false;
#endif
}

class Connection {
public:
    /// Prepares a connection; the server is not contacted yet.
    static Result<std::unique_ptr<Connection>> open(const Endpoint& endpoint) noexcept {
        return guarded([&]() -> Result<std::unique_ptr<Connection>> {
            static std::once_flag once;
            static CURLcode global = CURLE_FAILED_INIT;
            std::call_once(once, [] { global = curl_global_init(CURL_GLOBAL_DEFAULT); });
            if (global != CURLE_OK) return Error(Code::internal, curl_easy_strerror(global));
            if (endpoint.url.rfind("http://", 0) != 0 && endpoint.url.rfind("https://", 0) != 0)
                return Error(Code::invalid, "/url", "begins with http:// or https://");
            for (const char c : endpoint.key)
                if (static_cast<unsigned char>(c) < 0x21 || static_cast<unsigned char>(c) > 0x7e) return Error(Code::invalid, "/key", "not a key's secret");
            std::unique_ptr<Connection> connection(new Connection(endpoint));
            if (connection->curl_ == nullptr) return Error(Code::out_of_memory);
            return connection;
        });
    }

    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    ~Connection() { curl_easy_cleanup(curl_); }

    /// Sends a request and waits for its answer, of whatever status, or until `abandoned`.
    Result<Response> send(const Request& request, bool is_compressed = false, const std::atomic<bool>* abandoned = nullptr) noexcept {
        return guarded([&]() -> Result<Response> {
            Transfer transfer{{}, endpoint_.max_answer_bytes, abandoned, false};
            List headers;
            bool listed = headers.add("expect:") && headers.add("user-agent: revisit-cpp");
            if (!request.body.empty()) listed = listed && headers.add("content-type: " + request.content_type);
            if (is_compressed) listed = listed && headers.add("content-encoding: zstd");
            if (!endpoint_.key.empty()) listed = listed && headers.add("authorization: Bearer " + endpoint_.key);
            for (const auto& header : request.headers) listed = listed && headers.add(header.first + ": " + header.second);
            if (!listed) return Error(Code::out_of_memory);

            curl_easy_reset(curl_);
            const std::string url = endpoint_.url + request.target;
            char reason[CURL_ERROR_SIZE] = "";
            set(CURLOPT_URL, url.c_str());
            set(CURLOPT_CUSTOMREQUEST, request.method.c_str());
            set(CURLOPT_HTTPHEADER, headers.first);
            set(CURLOPT_ERRORBUFFER, reason);
            // Without it a timeout raises SIGALRM in the host.
            set(CURLOPT_NOSIGNAL, 1L);
            set(CURLOPT_CONNECTTIMEOUT_MS, endpoint_.connect_timeout_ms);
            set(CURLOPT_TIMEOUT_MS, endpoint_.timeout_ms);
            set(CURLOPT_ACCEPT_ENCODING, "");
            set(CURLOPT_WRITEFUNCTION, &Connection::on_body);
            set(CURLOPT_WRITEDATA, &transfer);
            set(CURLOPT_HEADERFUNCTION, &Connection::on_header);
            set(CURLOPT_HEADERDATA, &transfer);
            set(CURLOPT_NOPROGRESS, 0L);
            set(CURLOPT_XFERINFOFUNCTION, &Connection::on_progress);
            set(CURLOPT_XFERINFODATA, &transfer);
            if (!endpoint_.ca_file.empty()) set(CURLOPT_CAINFO, endpoint_.ca_file.c_str());
            if (!request.body.empty() || request.method == "POST" || request.method == "PUT" || request.method == "PATCH") {
                set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(request.body.size()));
                set(CURLOPT_POSTFIELDS, request.body.c_str());
            }
            const CURLcode code = curl_easy_perform(curl_);
            if (transfer.is_out_of_memory || code == CURLE_OUT_OF_MEMORY) return Error(Code::out_of_memory);
            if (code == CURLE_ABORTED_BY_CALLBACK) return Error(Code::abandoned, "the sender is closing");
            if (code == CURLE_WRITE_ERROR) return Error(Code::malformed_answer, "the answer is longer than max_answer_bytes");
            if (code != CURLE_OK) {
                Error error(Code::unreachable, reason[0] != '\0' ? reason : curl_easy_strerror(code));
                error.is_timeout = code == CURLE_OPERATION_TIMEDOUT;
                return error;
            }
            long status = 0;
            curl_easy_getinfo(curl_, CURLINFO_RESPONSE_CODE, &status);
            transfer.response.status = static_cast<int>(status);
            return std::move(transfer.response);
        });
    }

private:
    struct Transfer {
        Response response;
        std::size_t max_bytes;
        const std::atomic<bool>* abandoned;
        bool is_out_of_memory;
    };

    struct List {
        curl_slist* first = nullptr;
        List() = default;
        List(const List&) = delete;
        List& operator=(const List&) = delete;
        ~List() { curl_slist_free_all(first); }
        bool add(const std::string& header) {
            curl_slist* longer = curl_slist_append(first, header.c_str());
            if (longer == nullptr) return false;
            first = longer;
            return true;
        }
    };

    explicit Connection(const Endpoint& endpoint) : endpoint_(endpoint), curl_(curl_easy_init()) {
        while (!endpoint_.url.empty() && endpoint_.url.back() == '/') endpoint_.url.pop_back();
    }

    template <class T>
    void set(CURLoption option, T value) {
        curl_easy_setopt(curl_, option, value);
    }

    // libcurl is C: nothing may be thrown through it.
    static std::size_t on_body(char* data, std::size_t, std::size_t count, void* to) noexcept {
        auto& transfer = *static_cast<Transfer*>(to);
        if (transfer.response.body.size() + count > transfer.max_bytes) return 0;
        try {
            transfer.response.body.append(data, count);
        } catch (...) {
            transfer.is_out_of_memory = true;
            return 0;
        }
        return count;
    }

    static std::size_t on_header(char* data, std::size_t, std::size_t count, void* to) noexcept {
        auto& transfer = *static_cast<Transfer*>(to);
        const auto value = [&](const char* name) -> const char* {
            std::size_t i = 0;
            for (; name[i] != '\0'; ++i) {
                if (i >= count) return nullptr;
                const char c = data[i] >= 'A' && data[i] <= 'Z' ? static_cast<char>(data[i] + 32) : data[i];
                if (c != name[i]) return nullptr;
            }
            while (i < count && data[i] == ' ') ++i;
            return i < count ? data + i : nullptr;
        };
        // A header line ends with CR LF, so that strtod stops there.
        if (const char* seconds = value("retry-after:")) {
            if (*seconds >= '0' && *seconds <= '9') transfer.response.retry_after_s = std::strtod(seconds, nullptr);
        }
        if (const char* replayed = value("idempotent-replayed:")) transfer.response.is_replayed = *replayed == 't';
        return count;
    }

    static int on_progress(void* from, curl_off_t, curl_off_t, curl_off_t, curl_off_t) noexcept {
        const auto* abandoned = static_cast<Transfer*>(from)->abandoned;
        return abandoned != nullptr && abandoned->load() ? 1 : 0;
    }

    Endpoint endpoint_;
    CURL* curl_;
};

}  // namespace detail
}  // namespace revisit
