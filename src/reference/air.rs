//! The clear air in `f64`, by brute force and in planet-centred coordinates: another form than the shaders', so that what
//! the two agree in is not a shared mistake. One light at a time; media and lights come from the same [`AirUniforms`].

use std::f64::consts::PI;

use glam::DVec3;

use crate::render::uniforms::air::AirUniforms;

/// The air around a planet whose centre is the origin.
#[derive(Clone, Copy, Debug)]
pub struct Air {
    constants: AirUniforms,
    radius_m: f64,
    top_m: f64,
}

/// Scattering and extinction at a point, per metre.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Rayleigh scattering.
    pub rayleigh: DVec3,
    /// Aerosol scattering.
    pub mie: DVec3,
    /// Scattering and absorption of everything.
    pub extinction: DVec3,
}

/// Light gathered along a ray, and what the ray lets through.
#[derive(Clone, Copy, Debug)]
pub struct Gathered {
    /// Radiance per unit illuminance of the light, 1/sr.
    pub light: DVec3,
    /// Transmittance to the ray's end.
    pub transmittance: DVec3,
    /// Share of a uniform unit glow that is scattered into the ray.
    pub share: DVec3,
}

fn exp(v: DVec3) -> DVec3 {
    DVec3::new(v.x.exp(), v.y.exp(), v.z.exp())
}

fn henyey_greenstein(g: f64, cosine: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
}

impl Air {
    /// The air these uniforms describe.
    pub fn new(constants: AirUniforms) -> Self {
        let radius_m = f64::from(constants.planet_radius_m);
        Self { constants, radius_m, top_m: f64::from(constants.top_altitude_m) }
    }

    /// The point at an altitude above the world's origin.
    pub fn above_origin(&self, altitude_m: f64) -> DVec3 {
        DVec3::new(0.0, self.radius_m + altitude_m, 0.0)
    }

    /// The medium at a point.
    pub fn medium(&self, p: DVec3) -> Medium {
        let c = &self.constants;
        let altitude = (p.length() - self.radius_m).max(0.0);
        let mie = (-altitude / f64::from(c.mie_scale_height_m)).exp();
        let rayleigh =
            c.rayleigh_scattering_per_m.as_dvec3() * (-altitude / f64::from(c.rayleigh_scale_height_m)).exp();
        let tent = 1.0 - (altitude - f64::from(c.ozone_centre_m)).abs() / f64::from(c.ozone_half_width_m);
        let absorbed = c.mie_absorption_per_m.as_dvec3() * mie;
        let scattered = c.mie_scattering_per_m.as_dvec3() * mie;
        let ozone = c.ozone_absorption_per_m.as_dvec3() * tent.max(0.0);
        Medium { rayleigh, mie: scattered, extinction: rayleigh + scattered + absorbed + ozone }
    }

    /// The aerosol's phase function, 1/sr, as a product of Henyey-Greenstein forms.
    pub fn aerosol_phase(&self, cosine: f64) -> f64 {
        let g = f64::from(self.constants.mie_anisotropy);
        let narrow = 1.5 * (1.0 + cosine * cosine) / (2.0 + g * g) * henyey_greenstein(g, cosine);
        let broad = henyey_greenstein(f64::from(self.constants.mie_broad_anisotropy), cosine);
        let share = f64::from(self.constants.mie_broad_share);
        narrow * (1.0 - share) + broad * share
    }

    /// Metres to the sphere at `altitude_m`: the far root, and the near one if the sphere is ahead.
    fn roots(&self, p: DVec3, dir: DVec3, altitude_m: f64) -> Option<(f64, f64)> {
        let b = p.dot(dir);
        let sphere = self.radius_m + altitude_m;
        let root = b * b - (p.length_squared() - sphere * sphere);
        (root >= 0.0).then(|| (-b - root.sqrt(), -b + root.sqrt()))
    }

    /// Metres to the end of a ray, and whether that is the ground.
    pub fn end(&self, p: DVec3, dir: DVec3) -> (f64, bool) {
        match self.roots(p, dir, 0.0) {
            Some((near, _)) if near > -1e-3 && p.dot(dir) < 0.0 => (near.max(0.0), true),
            _ => (self.roots(p, dir, self.top_m).map_or(0.0, |(_, far)| far.max(0.0)), false),
        }
    }

    /// Optical depth from a point to the top of the air, the planet taken as transparent.
    pub fn optical_depth(&self, p: DVec3, dir: DVec3, steps: u32) -> DVec3 {
        let end = self.roots(p, dir, self.top_m).map_or(0.0, |(_, far)| far.max(0.0));
        let lowest = (-p.dot(dir)).clamp(0.0, end);
        let mut depth = DVec3::ZERO;
        for (from, length) in [(lowest, end - lowest), (lowest, -lowest)] {
            for step in 0..steps {
                let x = (f64::from(step) + 0.5) / f64::from(steps);
                let at = self.medium(p + dir * (from + length * x * x));
                depth += at.extinction * (2.0 * x * length.abs() / f64::from(steps));
            }
        }
        depth
    }

    /// What part of a light reaches a point: the share of its disc above the planet's edge, by area, times the air.
    pub fn light_transmittance(&self, p: DVec3, towards: DVec3, steps: u32) -> DVec3 {
        let radius = p.length();
        let dip = (self.radius_m / radius).min(1.0).acos();
        let cosine = (p.dot(towards) / radius).clamp(-1.0, 1.0);
        let height = (0.5 * PI - cosine.acos() + dip) / f64::from(self.constants.sun_angular_radius);
        let x = height.clamp(-1.0, 1.0);
        let share = 0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI;
        if share <= 0.0 {
            return DVec3::ZERO;
        }
        // What is still to be seen of a half-set disc stands at the horizon.
        let up = p / radius;
        let lowest = -dip.sin();
        let level = (towards - up * cosine).normalize_or(DVec3::X);
        let seen = cosine.max(lowest);
        let dir = up * seen + level * (1.0 - seen * seen).max(0.0).sqrt();
        exp(-self.optical_depth(p, dir, steps)) * share
    }

    /// Walks a ray in `steps`. With `glow`, adds that isotropic radiance per unit illuminance and uses the true phase
    /// functions; without, scatters evenly, and the ground reflects, as the second order of scattering is defined.
    pub fn gather(
        &self,
        (p, dir): (DVec3, DVec3),
        towards: DVec3,
        steps: u32,
        glow: Option<&dyn Fn(DVec3) -> DVec3>,
    ) -> Gathered {
        let (end, hits_ground) = self.end(p, dir);
        let lowest = (-p.dot(dir)).clamp(0.0, end);
        let cosine = dir.dot(towards);
        let rayleigh_phase = 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
        let mut out = Gathered { light: DVec3::ZERO, transmittance: DVec3::ONE, share: DVec3::ZERO };
        let boundary = |i: u32| {
            let x = f64::from(i) / f64::from(steps) - 1.0;
            if x < 0.0 { lowest * (1.0 - x * x) } else { lowest + (end - lowest) * x * x }
        };
        for i in 0..2 * steps {
            let (from, to) = (boundary(i), boundary(i + 1));
            let at = p + dir * (0.5 * (from + to));
            let medium = self.medium(at);
            let through = exp(-medium.extinction * (to - from));
            let weight = out.transmittance * (DVec3::ONE - through) / medium.extinction;
            let direct = self.light_transmittance(at, towards, 60);
            let scattering = medium.rayleigh + medium.mie;
            out.light += weight
                * match glow {
                    Some(glow) => {
                        let once = medium.rayleigh * rayleigh_phase + medium.mie * self.aerosol_phase(cosine);
                        direct * once + glow(at) * scattering
                    }
                    None => direct * scattering / (4.0 * PI),
                };
            out.share += weight * scattering;
            out.transmittance *= through;
        }
        if hits_ground && glow.is_none() {
            let albedo = self.constants.ground_albedo.as_dvec3();
            let ground = p + dir * end;
            let facing = (ground.dot(towards) / ground.length()).max(0.0);
            out.light += out.transmittance * self.light_transmittance(ground, towards, 60) * albedo * facing / PI;
            out.share += out.transmittance * albedo;
        }
        out
    }

    /// All orders above the first at a point, as one isotropic radiance per unit illuminance.
    pub fn multiple_scattering(&self, p: DVec3, towards: DVec3, directions: u32) -> DVec3 {
        let (mut light, mut share) = (DVec3::ZERO, DVec3::ZERO);
        let up = p.normalize();
        let east = up.any_orthonormal_vector();
        let north = up.cross(east);
        for i in 0..directions {
            let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(directions);
            let (sine, cosine) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let dir = up * y + (east * sine + north * cosine) * (1.0 - y * y).sqrt();
            let gathered = self.gather((p, dir), towards, 16, None);
            light += gathered.light / f64::from(directions);
            share += gathered.share / f64::from(directions);
        }
        light / (DVec3::ONE - share)
    }
}
