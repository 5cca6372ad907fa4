/* The device under test of a comparison. */
#include <stdio.h>

#include "bench/cli/compare_job.h"

static const char *const PATHS[] = {[DIF_GPU_COMPUTE] = "compute", [DIF_GPU_FRAGMENT] = "fragment"};
static const char *const FAULTS[] = {"none", "plane", "sign", "tap"};

dif_status dif_compare_device_open(bool require_hardware, dif_compare_device *device, dif_error *err)
{
    dif_gpu_opts opts = dif_gpu_opts_default();
    opts.require_hardware = require_hardware;
    return dif_gpu_open(&opts, &device->gpu, err);
}

void dif_compare_device_close(dif_compare_device *device)
{
    if (device->gpu)
        dif_gpu_close(device->gpu);
    device->gpu = NULL;
}

static dif_status open_path(void *self, int path, const dif_model *model, dif_evaluator *out, dif_error *err)
{
    const dif_compare_device *device = self;
    dif_gpu_eval_opts opts = dif_gpu_eval_opts_default();
    if (!device->gpu)
        return dif_cpu_evaluator_open(model, out, err);
    opts.path = (dif_gpu_path)device->path[path];
    opts.fault = device->fault;
    opts.half = device->half;
    return dif_gpu_evaluator_open(device->gpu, model, &opts, out, err);
}

dif_regress_device dif_compare_device_of(dif_compare_device *device)
{
    device->name[0] = device->gpu ? PATHS[device->path[0]] : "cpu";
    device->name[1] = PATHS[device->path[1]];
    return (dif_regress_device){device, device->gpu ? device->n_path : 1, device->name, open_path};
}

/* What stands for a GPU where there is none. */
static dif_gpu_info info_of(const dif_compare_device *device)
{
    dif_gpu_info info = {.renderer = "the reference itself, with the device's tolerance", .platform = "cpu"};
    return device->gpu ? dif_gpu_info_of(device->gpu) : info;
}

json_t *dif_compare_device_json(const dif_compare_device *device)
{
    const dif_gpu_info info = info_of(device);
    return json_pack("{s:s, s:s, s:s, s:s, s:b, s:b, s:b, s:i, s:i, s:s, s:b}", "renderer", info.renderer, "vendor",
                     info.vendor, "version", info.version, "platform", info.platform, "software", (int)info.software,
                     "float_linear", (int)info.float_linear, "timer", (int)info.timer, "texture_max", info.texture_max,
                     "layers_max", info.layers_max, "fault", FAULTS[device->fault], "half", (int)device->half);
}

dif_status dif_compare_device_describe(const dif_compare_device *device, dif_manifest *manifest, dif_error *err)
{
    const dif_gpu_info info = info_of(device);
    dif_status status = dif_manifest_set(manifest, "gpu_renderer", info.renderer, err);
    if (status == DIF_OK && device->gpu)
        status = dif_manifest_set(manifest, "gpu_vendor", info.vendor, err);
    if (status == DIF_OK && device->gpu)
        status = dif_manifest_set(manifest, "gpu_version", info.version, err);
    if (status == DIF_OK && device->gpu)
        status = dif_manifest_setf(manifest, err, "gpu_platform", "%s%s", info.platform,
                                   info.software ? ", software renderer" : "");
    if (status == DIF_OK && device->fault != DIF_GPU_FAULT_NONE)
        status = dif_manifest_setf(manifest, err, "gpu_fault", "%s: deliberately wrong", FAULTS[device->fault]);
    return status;
}
