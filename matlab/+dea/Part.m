function part = Part(law, parameters, varargin)
  % Material of a part of a dea.Solid, as a struct; several parts are an array of them.
  %
  %   dea.Part('neo-hookean', 0.4e6)
  %   dea.Part('yeoh', [178.4e3, -6e3, 4.2e3], 'pre_stretch', 1.2, 'permittivity', 2.8, ...)
  %   dea.Part('', [], 'young_modulus_Pa', 3e9, 'poisson_ratio', 0.38)   % compressible
  %
  % A law is incompressible (dea.laws). Options, in SI, with what they are when not given:
  %   'young_modulus_Pa', 'poisson_ratio'  0      without a law; the ratio below 0.49
  %   'bulk_modulus_Pa'                    0      of the law's iteration to volume 1; 0: 100 times
  %                                               the shear modulus
  %   'pre_stretch'                        1      equibiaxial in x and y, of the law
  %   'permittivity'                       0      relative
  %   'electrode_gap_m'                    0      height that the voltage stands over; 0: the part
  %                                               is not between electrodes
  %   'density_kg_per_m3'                  0      for modes
  %   'channel_above', 'channel_below'     0      of these electrodes, from 1, or 0 for ground; both
  %                                               0: channel 1 above ground
  part = dea.options(struct('young_modulus_Pa', 0, 'poisson_ratio', 0, 'bulk_modulus_Pa', 0, ...
                            'pre_stretch', 1, 'permittivity', 0, 'electrode_gap_m', 0, ...
                            'density_kg_per_m3', 0, 'channel_above', 0, 'channel_below', 0), ...
                     varargin);
  part.law = char(law);
  part.parameters = double(parameters(:));
end
