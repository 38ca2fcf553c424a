// Embree against `lumbre rays`: traces the rays of a file that `lumbre rays SCENE --export FILE` wrote, one by one (rtcIntersect1,
// rtcOccluded1) and in packets of 16, on so many threads, and prints Mrays/s as JSON. benches/against_embree.py builds and runs it.
//
//     g++ -O3 -march=native -std=c++17 benches/peers/embree.cpp -lembree3 -pthread -o embree     (or -lembree4)
//     embree FILE THREADS RUNS
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

struct Record {
    float origin[3], direction[3], t_max;
};

struct Set {
    std::string kind;
    bool any;
    std::vector<Record> rays;
};

static double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

static RTCRay ray_of(const Record& r) {
    RTCRay ray{};
    ray.org_x = r.origin[0], ray.org_y = r.origin[1], ray.org_z = r.origin[2];
    ray.dir_x = r.direction[0], ray.dir_y = r.direction[1], ray.dir_z = r.direction[2];
    ray.tnear = 0.0f, ray.tfar = r.t_max, ray.mask = 0xffffffffu;
    return ray;
}

#if RTC_VERSION_MAJOR >= 4
static void intersect(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, ray); }
static void occluded(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, ray); }
static void intersect16(const int* valid, RTCScene scene, RTCRayHit16* rays, bool coherent) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(valid, scene, rays, &arguments);
}
static void occluded16(const int* valid, RTCScene scene, RTCRay16* rays) { rtcOccluded16(valid, scene, rays); }
#else
static void intersect(RTCScene scene, RTCRayHit* ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, ray);
}
static void occluded(RTCScene scene, RTCRay* ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, ray);
}
static void intersect16(const int* valid, RTCScene scene, RTCRayHit16* rays, bool coherent) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &context, rays);
}
static void occluded16(const int* valid, RTCScene scene, RTCRay16* rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, rays);
}
#endif

// Traces rays [first, last); returns how many hit.
static size_t trace_single(RTCScene scene, const Set& set, const std::vector<Record>& rays, size_t first, size_t last) {
    size_t hits = 0;
    for (size_t i = first; i < last; i++) {
        if (set.any) {
            RTCRay ray = ray_of(rays[i]);
            occluded(scene, &ray);
            hits += ray.tfar < 0.0f;
        } else {
            RTCRayHit hit;
            hit.ray = ray_of(rays[i]);
            hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            intersect(scene, &hit);
            hits += hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
    }
    return hits;
}

static size_t trace_packets(RTCScene scene, const Set& set, const std::vector<Record>& rays, size_t first, size_t last, bool coherent) {
    size_t hits = 0;
    for (size_t base = first; base < last; base += 16) {
        alignas(64) int valid[16];
        alignas(64) RTCRayHit16 packet;
        for (size_t lane = 0; lane < 16; lane++) {
            const Record& r = rays[std::min(base + lane, last - 1)];
            valid[lane] = base + lane < last ? -1 : 0;
            packet.ray.org_x[lane] = r.origin[0], packet.ray.org_y[lane] = r.origin[1], packet.ray.org_z[lane] = r.origin[2];
            packet.ray.dir_x[lane] = r.direction[0], packet.ray.dir_y[lane] = r.direction[1], packet.ray.dir_z[lane] = r.direction[2];
            packet.ray.tnear[lane] = 0.0f, packet.ray.tfar[lane] = r.t_max, packet.ray.time[lane] = 0.0f;
            packet.ray.mask[lane] = 0xffffffffu, packet.ray.id[lane] = 0, packet.ray.flags[lane] = 0;
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
            packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        if (set.any) occluded16(valid, scene, &packet.ray);
        else intersect16(valid, scene, &packet, coherent);
        for (size_t lane = 0; lane < 16; lane++)
            if (valid[lane]) hits += set.any ? packet.ray.tfar[lane] < 0.0f : packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

int main(int count, char** arguments) {
    if (count != 4) {
        std::cerr << "usage: embree FILE THREADS RUNS (FILE as `lumbre rays SCENE --export FILE` writes it)\n";
        return 2;
    }
    std::ifstream in(arguments[1], std::ios::binary);
    const int threads = std::max(1, std::atoi(arguments[2])), runs = std::max(1, std::atoi(arguments[3]));
    std::string line;
    size_t triangles = 0;
    std::vector<Set> sets;
    std::getline(in, line);
    if (line != "lumbre-rays-1") {
        std::cerr << arguments[1] << ": not a file of rays: its first line must be lumbre-rays-1\n";
        return 2;
    }
    while (std::getline(in, line) && line != "end") {
        std::istringstream words(line);
        std::string kind, wants;
        size_t number;
        words >> kind >> number >> wants;
        if (kind == "triangles") triangles = number;
        else sets.push_back({kind, wants == "any", std::vector<Record>(number)});
    }

    RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * triangles));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles));
    in.read(reinterpret_cast<char*>(vertices), 36 * triangles);
    std::iota(indices, indices + 3 * triangles, 0u);
    for (Set& set : sets) in.read(reinterpret_cast<char*>(set.rays.data()), sizeof(Record) * set.rays.size());
    if (!in) {
        std::cerr << arguments[1] << ": it ends too early\n";
        return 2;
    }
    rtcCommitGeometry(geometry);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST); // no ray slips between neighbours, as in lumbre
    rtcAttachGeometry(scene, geometry);
    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene);
    std::printf("{\"renderer\": \"Embree %s\", \"threads\": %d, \"build_seconds\": %.4f, \"throughput\": [", RTC_VERSION_STRING, threads, seconds_since(start));

    bool first_row = true;
    for (const Set& set : sets) {
        std::vector<Record> shuffled = set.rays;
        std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(1));
        for (bool in_order : {true, false}) {
            const std::vector<Record>& rays = in_order ? set.rays : shuffled;
            for (bool packets : {false, true}) {
                std::vector<double> rates;
                size_t hits = 0;
                for (int run = 0; run <= runs; run++) {
                    std::vector<size_t> found(threads, 0);
                    std::vector<std::thread> workers;
                    const auto begun = std::chrono::steady_clock::now();
                    // Threads take runs of rays in turn, as the scene is not the same everywhere.
                    std::atomic<size_t> next{0};
                    const size_t piece = 4096;
                    for (int worker = 0; worker < threads; worker++)
                        workers.emplace_back([&, worker] {
                            for (size_t at = next.fetch_add(piece); at < rays.size(); at = next.fetch_add(piece)) {
                                const size_t end = std::min(at + piece, rays.size());
                                found[worker] += packets ? trace_packets(scene, set, rays, at, end, in_order && set.kind == "primary")
                                                         : trace_single(scene, set, rays, at, end);
                            }
                        });
                    for (std::thread& worker : workers) worker.join();
                    if (run > 0) rates.push_back(rays.size() / seconds_since(begun) / 1e6);
                    hits = std::accumulate(found.begin(), found.end(), size_t(0));
                }
                std::sort(rates.begin(), rates.end());
                std::printf("%s{\"kind\": \"%s\", \"in_order\": %s, \"packets\": %s, \"mrays_per_s\": %.4f, \"hit\": %.6f}", first_row ? "" : ", ",
                            set.kind.c_str(), in_order ? "true" : "false", packets ? "true" : "false", rates[rates.size() / 2],
                            double(hits) / double(rays.size()));
                first_row = false;
            }
        }
    }
    std::printf("]}\n");
    rtcReleaseScene(scene);
    rtcReleaseGeometry(geometry);
    rtcReleaseDevice(device);
}
